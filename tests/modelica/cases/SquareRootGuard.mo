// noEvent protects a root from a negative operand: the branch that is not taken must not be computed into the result.
model SquareRootGuard
  Real x;
  output Real y;
  output Real z;
equation
  x = 1 - 2 * time;
  y = noEvent(if x > 0 then sqrt(x) else 0);
  z = noEvent(if abs(x) > 1e-9 then sin(x) / x else 1);
end SquareRootGuard;
