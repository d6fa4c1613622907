// reinit of a velocity at a state event, many times over, each bounce later than the last by less.
model BouncingBall
  parameter Real g = 9.81;
  parameter Real e = 0.8;
  Real h(start = 1, fixed = true);
  Real v(start = 0, fixed = true);
  discrete Integer bounces(start = 0, fixed = true);
  output Real height;
  output Integer count;
equation
  der(h) = v;
  der(v) = -g;
  when h < 0 then
    reinit(v, -e * pre(v));
    bounces = pre(bounces) + 1;
  end when;
  height = h;
  count = bounces;
end BouncingBall;
