// Springs, dampers and masses in one line with derivatives in the equations: der(der(s)) through velocities, one massless node.
model SpringMassChain
  parameter Real m = 1;
  parameter Real c = 40;
  parameter Real d = 0.5;
  Real s(start = 0.2, fixed = true);
  Real v(start = 0, fixed = true);
  Real node;
  output Real y;
  output Real z;
equation
  v = der(s);
  m * der(v) = -c * (s - node) - d * v;
  c * (s - node) = 2 * c * node;
  y = s;
  z = node;
end SpringMassChain;
