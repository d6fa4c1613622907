model UnknownVariable
  output Real y;
equation
  y = 2 * speed; // refused: speed
end UnknownVariable;
