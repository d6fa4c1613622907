model IteratorOverValues
  input Real u(start = 1);
  output Real y;
equation
  y = sum(u * i for i in {3, 1, 2}); // refused: whole numbers
end IteratorOverValues;
