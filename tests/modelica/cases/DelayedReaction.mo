// A discrete variable that depends on a continuous one that depends on a discrete one, in the same instant.
model DelayedReaction
  Real level;
  discrete Real a(start = 1, fixed = true);
  discrete Real b(start = 0, fixed = true);
  output Real y[3];
equation
  level = 2 * a + time;
  when time >= 0.5 then
    a = pre(a) + 3;
  end when;
  when level > 5 then
    b = level + a;
  end when;
  y = {level, a, b};
end DelayedReaction;
