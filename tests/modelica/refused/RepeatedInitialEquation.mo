model RepeatedInitialEquation
  parameter Real w0 = 2;
  Real w(start = w0, fixed = true);
  Real load(start = -3 * w0, fixed = true);
  Real tau;
  output Real y;
  output Real z;
initial equation
  w + load / 3 = 0; // refused: do not determine
equation
  load = -3 * w;
  der(w) = 1 - tau;
  2 * der(load) = -6 * tau;
  y = w;
  z = tau;
end RepeatedInitialEquation;
