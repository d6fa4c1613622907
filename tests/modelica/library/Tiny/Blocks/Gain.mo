within Tiny.Blocks;
block Gain "Output the product of a gain value with the input signal"
  parameter Real k(start = 1, unit = "1");
  Interfaces.RealInput u;
  Interfaces.RealOutput y;
equation
  y = k * u;
end Gain;
