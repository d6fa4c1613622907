// Derivatives of a product, as an expression, and of a variable that is a quotient, and a derivative as an output.
model DerivativeOfExpression
  Real x(start = 1, fixed = true);
  Real w(start = 2, fixed = true);
  Real quotient;
  output Real product_rate;
  output Real quotient_rate;
  output Real acceleration;
equation
  der(x) = -0.5 * x + w;
  der(w) = -x;
  quotient = x / (1 + w ^ 2);
  product_rate = der(x * w /* of both */);
  quotient_rate = der(quotient);
  acceleration = {1, 1} * der({x, w});
end DerivativeOfExpression;
