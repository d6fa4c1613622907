model TooFewEquations // refused: equations
  Real x;
  output Real y;
equation
  y = x;
end TooFewEquations;
