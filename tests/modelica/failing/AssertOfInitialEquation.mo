// fails at the start: a root of
model AssertOfInitialEquation
  function root
    input Real x;
    output Real y;
  algorithm
    assert(x >= 0, "a root of " + String(x));
    y := sqrt(abs(x));
  end root;
  parameter Real square = -4;
  Real x;
  output Real y = x;
initial equation
  x = root(square);
equation
  der(x) = -x;
end AssertOfInitialEquation;
