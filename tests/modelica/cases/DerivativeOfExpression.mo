// Derivatives of variables that are expressions of states: a product and a quotient, and a derivative as an output.
model DerivativeOfExpression
  Real x(start = 1, fixed = true);
  Real w(start = 2, fixed = true);
  Real product;
  Real quotient;
  output Real product_rate;
  output Real quotient_rate;
  output Real acceleration;
equation
  der(x) = -0.5 * x + w;
  der(w) = -x;
  product = x * w;
  quotient = x / (1 + w ^ 2);
  product_rate = der(product);
  quotient_rate = der(quotient);
  acceleration = der(x) + der(w);
end DerivativeOfExpression;
