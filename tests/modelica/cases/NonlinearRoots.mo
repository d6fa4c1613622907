// A nonlinear equation with three roots: the start value tells which one; followed while it moves.
model NonlinearRoots
  Real low(start = -2);
  Real middle(start = 0.1);
  Real high(start = 2);
  output Real y[3];
equation
  low ^ 3 - 3 * low = 0.5 * sin(3 * time);
  middle ^ 3 - 3 * middle = 0.5 * sin(3 * time);
  high ^ 3 - 3 * high = 0.5 * sin(3 * time);
  y = {low, middle, high};
end NonlinearRoots;
