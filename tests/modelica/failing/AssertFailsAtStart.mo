// fails at the start: p must be positive
model AssertFailsAtStart
  parameter Real p = -1;
  output Real y;
equation
  assert(p > 0, "p must be positive");
  y = p * time;
end AssertFailsAtStart;
