// Time constants a million apart; the slow one is what can be seen.
model StiffDecay
  Real fast(start = 0, fixed = true);
  Real slow(start = 1, fixed = true);
  output Real y;
  output Real z;
equation
  der(fast) = -1e6 * (fast - cos(slow));
  der(slow) = -slow * fast;
  y = slow;
  z = fast;
end StiffDecay;
