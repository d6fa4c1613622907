// An initial algorithm with a loop computes a parameter that is not fixed; a start value follows from it.
model InitialAlgorithm
  parameter Real base = 1;
  parameter Real x0(fixed = false);
  Real x;
  output Real y;
initial algorithm
  x0 := base;
  for i in 1:4 loop
    x0 := x0 + 1 / i;
  end for;
initial equation
  x = x0;
equation
  der(x) = -x;
  y = x;
end InitialAlgorithm;
