// der() of an expression that is an array.
model DerivativeOfExpression
  Real x[2](each start = 1, each fixed = true);
  Real y[2];
  output Real z[2];
equation
  der(x) = -x;
  y = 2 * x;
  z = der(x + y); // refused: dimension
end DerivativeOfExpression;
