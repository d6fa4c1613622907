model ScalarOperator
  input Real u(start = 1);
  output Real y;
equation
  y = scalar([u]); // refused: scalar
end ScalarOperator;
