// when and elsewhen that become true together: the first holds; each alone does its own.
model ElsewhenPriority
  discrete Real d(start = 0, fixed = true);
  Real x(start = 0, fixed = true);
  output Real y;
equation
  der(x) = 1;
  when {time >= 0.25, time >= 0.5} then
    d = pre(d) + 1;
  elsewhen {x >= 0.125, time >= 0.5} then
    d = pre(d) + 100;
  elsewhen x > 0.65 then
    d = pre(d) + 10000;
  end when;
  y = d;
end ElsewhenPriority;
