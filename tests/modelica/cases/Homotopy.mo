// homotopy: which of several roots the start takes is that of the simplified expression, continued.
model Homotopy
  Real x;
  Real a;
  Real b(start = -3);
  Real s;
  Real k(start = 0.3);
  output Real y[5];
initial equation
  // s starts at 1, which the cubic's own start value 0 does not lead to.
  0 = homotopy(s ^ 3 - s, s - 1);
equation
  // The cubic with three roots, followed from the one near 1.
  homotopy(x ^ 3 - x, x - 1) = 0.1 * time;
  // Two equations, the simplified ones coupled otherwise.
  homotopy(a ^ 2 + b, a + b) = 6;
  a * homotopy(b, 2) = 4;
  der(s) = -s;
  // Explicit: no iteration, only the actual expression.
  k = homotopy(sin(time), 7);
  y = {x, a, b, s, k};
end Homotopy;
