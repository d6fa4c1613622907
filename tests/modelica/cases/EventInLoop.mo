// A clutch: a nonlinear loop whose equation changes at an event, with a root that jumps.
model EventInLoop
  Real x(start = 1);
  Real load;
  Real sum(start = 0, fixed = true);
  output Real y;
  output Real z;
equation
  load = if time < 0.5 then 2 else 20;
  x ^ 3 + x = load * (if x > 2 then 1.5 else 1);
  der(sum) = x;
  y = x;
  z = sum;
end EventInLoop;
