model TooManyEquations // refused: equations
  Real x;
  output Real y;
equation
  x = 1;
  x = time;
  y = x;
end TooManyEquations;
