// A pendulum that goes round under a gravity that is tuned, and a way that is set to 0 at the lowest point.
model PendulumWithReinit
  parameter Real g = 9.81;
  Real x(start = 0, fixed = true);
  Real y(start = -1);
  Real vx(start = 8, fixed = true);
  Real vy;
  Real F;
  Real way(start = 0, fixed = true);
  output Real across = x;
  output Real height = y;
  output Real passed = way;
equation
  der(x) = vx;
  der(y) = vy;
  der(vx) = -F * x;
  der(vy) = -F * y - g;
  x ^ 2 + y ^ 2 = 1;
  der(way) = sqrt(vx ^ 2 + vy ^ 2);
  when x > 0 and y < 0 then
    reinit(way, 0);
  end when;
end PendulumWithReinit;
