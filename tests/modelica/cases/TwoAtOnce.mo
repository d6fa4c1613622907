// Two states cross their limits in the same instant, and a third a tiny bit later, in a time that depends on the first two.
model TwoAtOnce
  Real a(start = 0, fixed = true);
  Real b(start = 1, fixed = true);
  Real c(start = 0, fixed = true);
  discrete Integer of_a(start = 0, fixed = true);
  discrete Integer of_b(start = 0, fixed = true);
  discrete Integer seen(start = 0, fixed = true);
  discrete Real both(start = 0, fixed = true);
  discrete Real third(start = 0, fixed = true);
  output Integer n[3];
  output Real at[2];
  output Real z;
equation
  der(a) = 1;
  der(b) = -1;
  der(c) = if of_a + of_b >= 2 then 3 else 1;
  when a > 0.5 then
    of_a = pre(of_a) + 1;
  end when;
  when b < 0.5 then
    of_b = pre(of_b) + 1;
  end when;
  when a > 0.5 and b < 0.5 then
    both = time;
  end when;
  when c > 0.5000001 then
    seen = of_a + of_b;
    third = time;
  end when;
  n = {of_a, of_b, seen};
  at = {both, third};
  z = c;
end TwoAtOnce;
