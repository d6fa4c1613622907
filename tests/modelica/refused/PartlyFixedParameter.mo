model PartlyFixedParameter // refused: fixed
  parameter Real p[2](start = {1, 2}, fixed = {true, false});
  Real x(start = 1, fixed = true);
  output Real y;
initial equation
  der(x) = 3;
equation
  der(x) = p[1] + p[2];
  y = x;
end PartlyFixedParameter;
