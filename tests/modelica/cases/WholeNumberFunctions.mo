// floor, ceil, integer of quantities that change sign: time events between the jumps.
model WholeNumberFunctions
  Real x;
  output Real down;
  output Real up;
  output Integer whole;
equation
  x = 4 * time - 1.7;
  down = floor(x);
  up = ceil(x);
  whole = integer(2 * x);
end WholeNumberFunctions;
