model SingularEquations
  Real a;
  Real b;
  Real c; // refused: one equation too few
  output Real y;
equation
  a = time;
  a = 2 * time; // refused: one too many
  y = b + c + a;
  y = b - a;
end SingularEquations;
