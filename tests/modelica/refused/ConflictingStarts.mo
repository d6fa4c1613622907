model ConflictingStarts
  parameter Real other = 5;
  Real x(start = 1, fixed = true);
  Real a(start = other, fixed = true); // refused: fixed start
  output Real y;
equation
  a = -x;
  der(x) = -x;
  y = a;
end ConflictingStarts;
