// Initial equations: derivatives that vanish, a nonlinear one with a root picked by start.
model SteadyState
  parameter Real u = 2;
  Real x;
  Real z(start = 1);
  output Real y;
  output Real w;
initial equation
  der(x) = 0;
  der(z) = 0;
equation
  der(x) = u - x + 0.5 * time;
  der(z) = x - z ^ 3;
  y = z;
  w = x;
end SteadyState;
