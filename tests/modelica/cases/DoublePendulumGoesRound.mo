// Two points on rods, in Cartesian coordinates: two of four coordinates are states, and which ones changes.
model DoublePendulumGoesRound
  parameter Real a = 1;
  parameter Real b = 0.7;
  parameter Real m = 0.5 "mass of the outer point; that of the inner one is 1";
  parameter Real g = 9.81;
  Real x1(start = 0, fixed = true);
  Real y1(start = -a);
  Real x2(start = 0, fixed = true);
  Real y2(start = -a - b);
  Real vx1(start = 8, fixed = true);
  Real vy1;
  Real vx2(start = 3, fixed = true);
  Real vy2;
  Real F1;
  Real F2;
  output Real p[4] = {x1, y1, x2, y2};
equation
  der(x1) = vx1;
  der(y1) = vy1;
  der(x2) = vx2;
  der(y2) = vy2;
  der(vx1) = -F1 * x1 + F2 * (x2 - x1);
  der(vy1) = -F1 * y1 + F2 * (y2 - y1) - g;
  m * der(vx2) = -F2 * (x2 - x1);
  m * der(vy2) = -F2 * (y2 - y1) - m * g;
  x1 ^ 2 + y1 ^ 2 = a ^ 2;
  (x2 - x1) ^ 2 + (y2 - y1) ^ 2 = b ^ 2;
end DoublePendulumGoesRound;
