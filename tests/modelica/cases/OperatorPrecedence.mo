// Minus before power, left association, Boolean precedence, division of integers gives a real number.
model OperatorPrecedence
  parameter Integer n = 3;
  parameter Integer m = 2;
  input Real u(start = 3);
  input Boolean p(start = true);
  output Real y[7];
  output Boolean b;
equation
  y[1] = -u ^ 2;
  y[2] = 100 / u / 2;
  y[3] = 10 - u - 2;
  y[4] = n / m;
  y[5] = 2 * u ^ 2 / 4 * 3;
  y[6] = -2 * (-u);
  y[7] = (n + 1) / (m * 4) + 7 / 2;
  b = not p and false or p and not false;
end OperatorPrecedence;
