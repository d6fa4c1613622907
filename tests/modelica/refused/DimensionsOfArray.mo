model DimensionsOfArray
  parameter Real q[2, 3] = [1, 2, 3; 4, 5, 6];
  output Real y;
equation
  y = ndims(q) * time; // refused: ndims
end DimensionsOfArray;
