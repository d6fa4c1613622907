within Motion;
block Line "Of two coefficients"
  output Real y;
protected
  function value
    input Real c[2];
    input Real x;
    output Real y;
  algorithm
    y := c[1] + c[2]*x;
  end value;
equation
  y = value({1, 2}, time);
end Line;
