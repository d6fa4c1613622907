// A loop with positive feedback and limits, in a model without states: the root is kept until its branch ends.
model RootsWithoutStates
  Real u = -cos(8*time);
  Real x(start = -6);
  output Real y;
equation
  x = 4*(u + 0.5*y);
  y = smooth(0, noEvent(if x > 1 then 1 elseif x < -1 then -1 else x));
end RootsWithoutStates;
