model DoubleRange // refused: range
  output Real y;
equation
  y = time * sum(0:0.5:2);
end DoubleRange;
