// Chains of variables that are equal or opposite; a start fixed at an alias of the opposite sign; outputs at both ends.
model NegatedAliases
  Real x;
  Real a(start = 3, fixed = true);
  Real b;
  Real c;
  Real d;
  output Real y;
  output Real z;
  output Real same;
  output Boolean positive;
  Boolean negative;
equation
  der(x) = -x;
  a = -x;
  b + a = 0;
  0 = c + b;
  d = -c;
  y = d;
  z = -d;
  same = y;
  positive = not negative;
  negative = a < 2;
end NegatedAliases;
