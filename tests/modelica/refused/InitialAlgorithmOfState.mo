// An initial algorithm with a loop gives start values.
model InitialAlgorithmOfState
  parameter Integer n = 4; // refused: initial algorithm
  Real x;
  output Real y;
initial algorithm
  x := 1;
  for i in 1:4 loop
    x := x + 1 / i;
  end for;
equation
  der(x) = -x;
  y = x;
end InitialAlgorithmOfState;
