// A four-bar linkage whose crank goes round, in coordinates of its joints: one of four is the state, in turn.
model FourBarLinkage
  parameter Real a = 1 "crank";
  parameter Real b = 3 "coupler";
  parameter Real c = 2.5 "rocker";
  parameter Real d = 2 "between the fixed joints";
  parameter Real m = 2 "mass of the rocker's joint; that of the crank's is 1";
  parameter Real g = 9.81;
  parameter Real w0 = 10;
  Real x1(start = a);
  Real y1(start = 0, fixed = true);
  Real x2(start = 2.9);
  Real y2(start = 2.3);
  Real vx1;
  Real vy1(start = a * w0, fixed = true);
  Real vx2;
  Real vy2;
  Real Fa;
  Real Fb;
  Real Fc;
  output Real p[4] = {x1, y1, x2, y2};
equation
  der(x1) = vx1;
  der(y1) = vy1;
  der(x2) = vx2;
  der(y2) = vy2;
  der(vx1) = -Fa * x1 + Fb * (x2 - x1);
  der(vy1) = -Fa * y1 + Fb * (y2 - y1) - g;
  m * der(vx2) = -Fb * (x2 - x1) - Fc * (x2 - d);
  m * der(vy2) = -Fb * (y2 - y1) - Fc * y2 - m * g;
  x1 ^ 2 + y1 ^ 2 = a ^ 2;
  (x2 - x1) ^ 2 + (y2 - y1) ^ 2 = b ^ 2;
  (x2 - d) ^ 2 + y2 ^ 2 = c ^ 2;
end FourBarLinkage;
