model Delay
  input Real u(start = 1);
  output Real y;
equation
  y = delay(u, 0.1); // refused: delay
end Delay;
