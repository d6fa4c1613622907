// Parameters that depend on parameters through several steps, in any order, and through a function; set from outside.
model DependentParameters
  function area
    input Real r;
    output Real a;
  algorithm
    a := 3 * r ^ 2;
  end area;
  parameter Real last = 2 * middle + shift;
  parameter Real middle = area(radius) - 1;
  parameter Real radius = 1;
  parameter Real shift = 0;
  parameter Real list[3] = {radius, middle, last};
  Real x(start = last, fixed = true);
  output Real y;
  output Real z;
equation
  der(x) = -radius * x;
  y = x;
  z = sum(list);
end DependentParameters;
