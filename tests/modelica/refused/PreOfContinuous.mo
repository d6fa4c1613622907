model PreOfContinuous // refused: pre
  Real x(start = 0, fixed = true);
  output Real y;
equation
  der(x) = 1;
  y = pre(x);
end PreOfContinuous;
