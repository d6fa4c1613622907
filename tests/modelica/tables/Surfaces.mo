model Surfaces "Tables over two inputs, with each extrapolation; derivatives by index reduction"
  import Modelica.Blocks.Types.{Extrapolation, Smoothness};
  parameter Real grid[4, 4] = [0, 1, 2, 4; 1, 1, 3, 5; 2, 2, 4, 9; 4, 0, 1, 2];
  parameter Real speed = 5;
  output Real lines;
  output Real held;
  output Real periodic;
  output Real stepped;
  output Real steps_held;
  output Real slope;
  output Real span;
protected
  Modelica.Blocks.Tables.Surface a(table = grid);
  Modelica.Blocks.Tables.Surface b(table = grid, extrapolation = Extrapolation.HoldLastPoint);
  Modelica.Blocks.Tables.Surface c(table = grid, extrapolation = Extrapolation.Periodic);
  Modelica.Blocks.Tables.Surface d(table = grid, smoothness = Smoothness.ConstantSegments);
  Modelica.Blocks.Tables.Surface e(table = grid, smoothness = Smoothness.ConstantSegments, extrapolation = Extrapolation.HoldLastPoint);
equation
  a.u1 = speed*time;
  a.u2 = 5 - 6*time;
  b.u1 = a.u1;
  b.u2 = a.u2;
  c.u1 = a.u1;
  c.u2 = a.u2;
  d.u1 = a.u1;
  d.u2 = a.u2;
  e.u1 = a.u1;
  e.u2 = a.u2;
  lines = a.y;
  held = b.y;
  periodic = c.y;
  stepped = d.y;
  steps_held = e.y;
  slope = der(lines);
  span = a.last[1] - a.first[2];
end Surfaces;
