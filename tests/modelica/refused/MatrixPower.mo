model MatrixPower
  Real A[2, 2] = [1, time; 3, 4];
  Real B[2, 2] = A ^ 2; // refused: power
  output Real y = B[1, 2];
end MatrixPower;
