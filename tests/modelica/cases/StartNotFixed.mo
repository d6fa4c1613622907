// Start values that are not fixed give way to initial equations; fixed ones do not; some come from an algebraic equation.
model StartNotFixed
  parameter Real a = 4;
  Real x(start = 100);
  Real w(start = 2, fixed = true);
  Real q;
  output Real y;
  output Real z;
initial equation
  q = a;
equation
  q = x + w;
  der(x) = -x;
  der(w) = x;
  y = x;
  z = w;
end StartNotFixed;
