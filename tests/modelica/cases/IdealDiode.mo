// An ideal diode by a curve parameter: Boolean and real unknowns in one loop, at an event; a rectifier with a capacitor.
model IdealDiode
  parameter Real R = 1;
  parameter Real C = 0.05;
  parameter Real load = 10;
  Boolean off(start = true);
  Real s(start = -1);
  Real v;
  Real i;
  Real source;
  Real u(start = 0, fixed = true);
  output Real voltage;
  output Real current;
equation
  source = 5 * sin(6.283185307179586 * time);
  off = s < 0;
  v = if off then s else 0;
  i = if off then 0 else s;
  source = R * i + v + u;
  C * der(u) = i - u / load;
  voltage = u;
  current = i;
end IdealDiode;
