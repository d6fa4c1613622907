model WrongType
  output Real y;
  Boolean b;
equation
  b = time > 1;
  y = b; // refused: Boolean
end WrongType;
