// A function that names its derivative, inside an equation that is differentiated.
model DerivativeAnnotation
  function square
    input Real x;
    output Real y;
  algorithm
    y := x * x;
    annotation(derivative = square_rate);
  end square;
  function square_rate
    input Real x;
    input Real rate;
    output Real y;
  algorithm
    y := 2 * x * rate;
  end square_rate;
  Real s;
  output Real y;
equation
  s = square(time);
  y = der(s);
end DerivativeAnnotation;
