// Two hundred switches in a second from a comparison with a saw tooth of sampled steps: a duty cycle, averaged.
model PulseTrain
  parameter Real duty = 0.3;
  discrete Real since(start = 0, fixed = true);
  Real x(start = 0, fixed = true);
  Boolean on;
  output Real y;
equation
  when sample(0, 0.01) then
    since = time;
  end when;
  on = time < since + duty * 0.01;
  der(x) = if on then 1 else 0;
  y = x;
end PulseTrain;
