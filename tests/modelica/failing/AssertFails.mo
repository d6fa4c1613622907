// fails: x grew beyond 0.5
model AssertFails
  Real x(start = 0, fixed = true);
  output Real y;
equation
  der(x) = 1;
  assert(x < 0.5, "x grew beyond 0.5");
  y = x;
end AssertFails;
