// Discrete variables started by start with fixed, by a start that is a parameter, and by when initial().
model InitialDiscrete
  discrete Real a(start = 3, fixed = true);
  parameter Real b0 = 6;
  discrete Real b(start = b0, fixed = true);
  discrete Real c(start = 0);
  Integer n(start = 5, fixed = true);
  output Real y[4];
equation
  when time > 0.5 then
    a = pre(a) + 1;
    b = pre(b) * 10;
    n = pre(n) + 2;
  end when;
  when {initial(), time > 0.25} then
    c = 7 + time;
  end when;
  y = {a, b, c, n};
end InitialDiscrete;
