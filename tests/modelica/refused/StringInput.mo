model StringInput
  input String s; // refused: string
  output Real y;
equation
  y = time;
end StringInput;
