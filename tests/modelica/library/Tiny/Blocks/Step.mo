within Tiny.Blocks;
block Step "Generate step signal of type Real"
  parameter Real height = 1;
  parameter Real offset = 0;
  parameter Real startTime(unit = "s") = 0;
  Interfaces.RealOutput y;
equation
  y = offset + (if time < startTime then 0 else height);
end Step;
