// Parameters in the places that front-ends like to evaluate: conditions, starts, array bindings, minimum and maximum, exponents.
model FoldedParameters
  parameter Boolean is_fast = false;
  parameter Integer order = 2;
  parameter Real x0 = 1;
  parameter Real limit = 5;
  parameter Real zero = 0;
  parameter Real gains[2] = {zero, x0};
  Real x(start = x0, fixed = true, max = limit);
  output Real y;
  output Real z;
  output Real w;
equation
  der(x) = if is_fast then -2 * x else -x;
  y = if zero > 0 then 100 else x ^ order;
  z = min(limit, zero * time + 10) + gains[1] * x;
  w = if order == 2 then gains[2] else -gains[2];
end FoldedParameters;
