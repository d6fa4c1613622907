// der() of a product and of a quotient, twice the same derivative, and a derivative as an output.
model DerivativeOfExpression // refused: der(...)
  Real x(start = 1, fixed = true);
  Real w(start = 2, fixed = true);
  output Real product_rate;
  output Real quotient_rate;
  output Real acceleration;
equation
  der(x) = -0.5 * x + w;
  der(w) = -x;
  product_rate = der(x * w);
  quotient_rate = der(x / (1 + w ^ 2));
  acceleration = der(x) + der(w);
end DerivativeOfExpression;
