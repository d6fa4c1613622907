// Matrix products, transposition, identity, outer and cross products, element-wise operators.
model MatrixAlgebra
  input Real u(start = 2);
  parameter Real A[2, 3] = [1, 2, 3; 4, 5, 6];
  Real P[2, 2];
  Real E[2, 3];
  Real c[3];
  output Real y[6];
equation
  P = A * transpose(A) - u * identity(2);
  E = A .* A ./ (A .+ u) - fill(1, 2, 3);
  c = cross({1, u, 3}, {u, -1, 0.5});
  y[1] = P[1, 2] + P[2, 2];
  y[2] = E[2, 3];
  y[3] = {1, 2, 3} * c;
  y[4] = sum(outerProduct({1, u}, {3, 4, 5}));
  y[5] = vector(transpose([1; u; 3]) * [4; 5; u]) * {1};
  y[6] = sum(A .^ 2) / max(A);
end MatrixAlgebra;
