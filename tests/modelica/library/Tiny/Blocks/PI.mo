within Tiny.Blocks;
block PI "Proportional-Integral controller"
  parameter Real k = 1;
  parameter Real T(start = 1, min = 1e-12);
  parameter Real x_start = 0;
  Interfaces.RealInput u;
  Interfaces.RealOutput y;
  Real x(start = x_start, fixed = true) "State of block";
equation
  der(x) = u / T;
  y = k * (x + u);
end PI;
