// fails at the start: continued from the simplified expressions of homotopy
model HomotopyEnds
  Real x;
  output Real y;
equation
  homotopy(x ^ 2 + 1, x - 1) = 0;
  y = x;
end HomotopyEnds;
