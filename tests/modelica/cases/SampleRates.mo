// Three sample times with offsets, the third from parameters; a continuous sum of what they hold.
model SampleRates
  parameter Real T = 0.15;
  constant Real third = 0.05;
  discrete Real a(start = 0, fixed = true);
  discrete Real b(start = 0, fixed = true);
  discrete Real c(start = 0, fixed = true);
  output Real y[4];
equation
  when sample(0, 0.1) then
    a = pre(a) + 1;
  end when;
  when sample(0.05, T) then
    b = time + pre(b);
  end when;
  when sample(0.2, third) then
    c = 2 * pre(c) + 1;
  end when;
  y = {a, b, c, a + 100 * b + 1000 * c};
end SampleRates;
