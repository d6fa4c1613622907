model DerivativeOfInput
  input Real u(start = 0);
  Real s;
  output Real y;
equation
  s = 2 * u; // refused: derivative of the input 'u'
  y = der(s);
end DerivativeOfInput;
