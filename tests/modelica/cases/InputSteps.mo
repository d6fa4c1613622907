// An input that jumps: a relation on it, a discrete memory of it, a direct path and a lag.
model InputSteps
  input Real u(start = 0);
  Real x(start = 0, fixed = true);
  discrete Real top(start = 0, fixed = true);
  discrete Integer rises(start = 0, fixed = true);
  Boolean above;
  output Real y;
  output Real z;
  output Integer n;
  output Real direct;
equation
  der(x) = u - x;
  above = u > 1;
  when above then
    top = u;
    rises = pre(rises) + 1;
  end when;
  y = x;
  z = top;
  n = rises;
  direct = if above then 2 * u else -u;
end InputSteps;
