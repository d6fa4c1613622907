// Three currents along a direction that turns: two linear constraints whose coefficients depend on the time.
model TurningCurrents
  parameter Real L = 0.2;
  parameter Real R = 0.5;
  parameter Real U = 3;
  parameter Real w = 5;
  parameter Real r = 3;
  Real i[3];
  Real v1;
  Real v2;
  Real across[3] = {-sin(w * time), cos(w * time) * cos(r * time), cos(w * time) * sin(r * time)};
  Real beside[3] = {0, -sin(r * time), cos(r * time)};
  output Real current[3] = i;
initial equation
  i[1] = 1;
equation
  L * der(i[1]) = U - R * i[1] - v1 * across[1] - v2 * beside[1];
  L * der(i[2]) = -R * i[2] - v1 * across[2] - v2 * beside[2];
  L * der(i[3]) = -R * i[3] - v1 * across[3] - v2 * beside[3];
  across * i = 0;
  beside * i = 0;
end TurningCurrents;
