within Motion;
block Curve "Of three coefficients"
  output Real y;
protected
  function value
    input Real c[3];
    input Real x;
    output Real y;
  algorithm
    y := c[1] + c[2]*x + c[3]*x^2;
  end value;
equation
  y = -value({1, 2, 3}, time);
end Curve;
