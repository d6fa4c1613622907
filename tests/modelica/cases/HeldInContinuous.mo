// A discrete variable read by continuous equations, and a continuous one sampled by when; no reinit.
model HeldInContinuous
  Real x(start = 1, fixed = true);
  discrete Real held(start = 0, fixed = true);
  Boolean upwards(start = true, fixed = true);
  output Real y;
  output Real z;
equation
  der(x) = (if upwards then 1 else -1) + 0 * held;
  when {x > 1.5, x < 0.9} then
    held = x + pre(held);
    upwards = x < 1;
  end when;
  y = x;
  z = held * x;
end HeldInContinuous;
