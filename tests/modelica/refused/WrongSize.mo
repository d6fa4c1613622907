model WrongSize
  Real a[2];
  Real b[3] = {1, 2, 3};
  output Real y;
equation
  a = b; // refused: 2
  y = sum(a);
end WrongSize;
