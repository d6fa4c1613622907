// A parameter as an index and as the bound of a sum: its value decides which equations there are.
model ParameterIndex
  parameter Integer gear = 1;
  parameter Real q[3] = {10, 20, 30};
  output Real y;
equation
  y = q[gear] + time;
end ParameterIndex;
