// A pendulum in Cartesian coordinates that goes round: neither of them is a good state all the way.
model PendulumGoesRound
  parameter Real L = 1;
  parameter Real g = 9.81;
  parameter Real v0 = 9;
  Real x(start = 0, fixed = true);
  Real y(start = -L);
  Real vx(start = v0, fixed = true);
  Real vy;
  Real F;
  output Real across = x;
  output Real height = y;
  output Real tension = F;
  output Real energy;
equation
  der(x) = vx;
  der(y) = vy;
  der(vx) = -F * x / L;
  der(vy) = -F * y / L - g;
  x ^ 2 + y ^ 2 = L ^ 2;
  energy = (vx ^ 2 + vy ^ 2) / 2 + g * y;
end PendulumGoesRound;
