// Three sample times with offsets; where they meet, the order is given by what depends on what.
model SamplesReadEachOther // refused: clock
  discrete Real a(start = 0, fixed = true);
  discrete Real b(start = 0, fixed = true);
  discrete Real c(start = 0, fixed = true);
  output Real y[3];
equation
  when sample(0, 0.1) then
    a = pre(a) + 1;
  end when;
  when sample(0.05, 0.15) then
    b = a + pre(b);
  end when;
  when sample(0.2, 0.1) then
    c = a + 100 * b;
  end when;
  y = {a, b, c};
end SamplesReadEachOther;
