// Parameters changed while the model runs: in the plant, in a relation, in a dependent parameter and in a held value.
model TunableParameters
  parameter Real rate = 1;
  parameter Real threshold = 10;
  parameter Real doubled = 2 * rate;
  Real x(start = 0, fixed = true);
  output Real y;
  output Real z;
  output Boolean above;
equation
  der(x) = rate;
  y = x;
  z = doubled;
  above = x > threshold;
end TunableParameters;
