model ClockedSample // refused: clock
  input Real u(start = 1);
  Real x(start = 0);
  output Real y;
equation
  x = sample(u, Clock(0.1));
  y = hold(x);
end ClockedSample;
