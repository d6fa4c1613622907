// Algebraic equations with limits in the loop: the branches have to be found together with the values.
model LoopWithLimits
  Real u;
  Real a;
  Real b;
  output Real y;
  output Real z;
equation
  u = 6 * time - 3;
  a = u - 0.5 * b;
  b = if a > 1 then 1 elseif a < -1 then -1 else a;
  y = a;
  z = b;
end LoopWithLimits;
