// fails: are singular: there are no states that could be selected
// A parallelogram of rods whose crank comes to where all are in line: two motions are possible from there.
model DeadPoint
  Real x1(start = 0.5);
  Real y1(start = sqrt(0.75), fixed = true);
  Real x2(start = 2.5);
  Real y2(start = sqrt(0.75));
  Real vx1(start = 3 * sqrt(0.75), fixed = true);
  Real vy1;
  Real vx2;
  Real vy2;
  Real Fa;
  Real Fb;
  Real Fc;
  output Real y = y1;
equation
  der(x1) = vx1;
  der(y1) = vy1;
  der(x2) = vx2;
  der(y2) = vy2;
  der(vx1) = -Fa * x1 + Fb * (x2 - x1);
  der(vy1) = -Fa * y1 + Fb * (y2 - y1);
  der(vx2) = -Fb * (x2 - x1) - Fc * (x2 - 2);
  der(vy2) = -Fb * (y2 - y1) - Fc * y2;
  x1 ^ 2 + y1 ^ 2 = 1;
  (x2 - x1) ^ 2 + (y2 - y1) ^ 2 = 4;
  (x2 - 2) ^ 2 + y2 ^ 2 = 1;
end DeadPoint;
