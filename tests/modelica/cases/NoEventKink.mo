// The same kinks with events, with noEvent and with smooth: the values must be the same.
model NoEventKink
  Real x(start = 0, fixed = true);
  Real a(start = 0, fixed = true);
  Real b(start = 0, fixed = true);
  Real c(start = 0, fixed = true);
  output Real y[3];
equation
  der(x) = 1;
  der(a) = if x < 0.4 then 1 else x;
  der(b) = noEvent(if x < 0.4 then 1 else x);
  der(c) = smooth(0, if x > 0.7 then (x - 0.7) ^ 2 else 0);
  y = {a, b, c};
end NoEventKink;
