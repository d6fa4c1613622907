// A function with an algorithm: for loop over a vector of unknown size, local variables with defaults.
model FunctionLoop
  function horner "value of a polynomial, highest power first"
    input Real c[:];
    input Real x;
    output Real y;
  protected
    Integer n = size(c, 1);
    Real scale = 2;
  algorithm
    y := c[1];
    for i in 2:n loop
      y := y * x + c[i];
    end for;
    y := scale * y;
  end horner;
  parameter Real c[4] = {1, -2, 0, 5};
  input Real u(start = 0.7);
  output Real y;
  output Real z;
equation
  y = horner(c, u);
  z = horner({u, 1}, u + time);
end FunctionLoop;
