// fails: number
model NegativeRoot
  Real x(start = 1, fixed = true);
  output Real y;
equation
  der(x) = -sqrt(x) - 1;
  y = x;
end NegativeRoot;
