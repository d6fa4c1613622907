// fails: NoRoot.mo
model NoRoot
  Real x(start = 1);
  output Real y;
equation
  x ^ 2 = 0.5 - time;
  y = x;
end NoRoot;
