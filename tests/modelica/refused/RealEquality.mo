model RealEquality // refused: equality
  Real x(start = 0, fixed = true);
  output Real y;
equation
  der(x) = 1;
  y = if x == 0.5 then 1 else 0;
end RealEquality;
