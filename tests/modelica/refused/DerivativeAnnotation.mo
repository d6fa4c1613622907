model DerivativeAnnotation
  function square
    input Real x;
    output Real y;
  algorithm
    y := x * x;
    annotation(derivative = square_rate); // refused: 'square_rate' is not its derivative
  end square;
  function square_rate
    input Real x;
    input Real rate;
    output Real y;
  algorithm
    y := 3 * x * rate;
  end square_rate;
  Real s;
  output Real y;
equation
  s = square(time);
  y = der(s);
end DerivativeAnnotation;
