model BooleanLoop // refused: `b`
  Boolean b(start = false);
  output Real y;
equation
  b = not b;
  y = if b then 1 else 0;
end BooleanLoop;
