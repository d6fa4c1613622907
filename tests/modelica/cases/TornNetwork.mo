// A ladder of nonlinear resistors: a long loop of simple assignments closed by one equation.
model TornNetwork
  constant Integer n = 6;
  parameter Real V = 10;
  Real v[n + 1];
  Real i[n];
  Real shunt[n];
  output Real y;
  output Real first;
equation
  v[1] = V;
  for k in 1:n loop
    v[k] - v[k + 1] = i[k] + 0.1 * i[k] ^ 3;
    shunt[k] = 0.5 * v[k + 1];
  end for;
  for k in 1:n - 1 loop
    i[k] = i[k + 1] + shunt[k];
  end for;
  i[n] = shunt[n];
  y = v[n + 1];
  first = i[1];
end TornNetwork;
