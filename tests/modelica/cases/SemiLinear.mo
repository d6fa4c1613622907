// semiLinear, and a homotopy that changes nothing.
model SemiLinear
  Real x;
  Real root(start = 1);
  output Real y;
  output Real z;
equation
  x = 1 - 2 * time;
  y = semiLinear(x, 2, 5);
  homotopy(root ^ 2, root) = 4 + time;
  z = root;
end SemiLinear;
