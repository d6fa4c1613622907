// An assertion that holds, and a warning that does not: the run goes on.
model AssertsAndWarnings
  Real x(start = 0, fixed = true);
  output Real y;
equation
  der(x) = 1;
  assert(x < 10, "x grew beyond 10");
  assert(x < 0.5, "x is beyond 0.5", AssertionLevel.warning);
  y = x;
end AssertsAndWarnings;
