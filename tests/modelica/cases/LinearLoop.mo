// Linear equations that depend on each other, with a coefficient that changes with time and with parameters.
model LinearLoop
  parameter Real k = 3;
  input Real u(start = 2);
  Real a;
  Real b;
  Real c;
  output Real y;
  output Real z;
equation
  a + k * b - c = u;
  2 * a - b + (1 + time) * c = 1;
  a * (2 + sin(time)) + b + c = -u;
  y = a + b;
  z = c;
end LinearLoop;
