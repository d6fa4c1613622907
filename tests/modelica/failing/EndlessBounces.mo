// fails: events
model EndlessBounces
  Real h(start = 1, fixed = true);
  Real v(start = 0, fixed = true);
  output Real y;
equation
  der(h) = v;
  der(v) = -9.81;
  when h < 0 then
    reinit(v, -0.3 * pre(v));
  end when;
  y = h;
end EndlessBounces;
