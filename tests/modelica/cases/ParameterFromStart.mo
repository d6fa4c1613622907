// A parameter with fixed = false is found from what shall hold at the start; another depends on it.
model ParameterFromStart
  parameter Real k(fixed = false, start = 1);
  parameter Real doubled = 2 * k;
  parameter Real target = 3;
  Real x(start = 1, fixed = true);
  output Real y;
  output Real z;
  output Real rate;
initial equation
  der(x) = target;
equation
  der(x) = k ^ 2 - x;
  y = x;
  z = doubled;
  rate = der(x);
end ParameterFromStart;
