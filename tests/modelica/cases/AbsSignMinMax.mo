// abs, sign, min and max along a path that crosses their corners.
model AbsSignMinMax
  Real x;
  output Real a;
  output Real s;
  output Real low;
  output Real high;
equation
  x = 1 - 2 * time;
  a = abs(x);
  s = sign(x);
  low = min(x, 0.5);
  high = max(x ^ 2, 0.25);
end AbsSignMinMax;
