// Fixed starts on both sides of a coupling that agree with each other.
model RedundantStart
  parameter Real w0 = 2;
  Real w(start = w0, fixed = true);
  Real load(start = -3 * w0, fixed = true);
  Real tau;
  output Real y;
  output Real z;
equation
  load = -3 * w;
  der(w) = 1 - tau;
  2 * der(load) = -6 * tau;
  y = w;
  z = tau;
end RedundantStart;
