// der(x) = A*x + B*u, y = C*x + D*u with matrices: a linear system in matrix form.
model MatrixStateSpace
  parameter Real A[2, 2] = [0, 1; -4, -0.4];
  parameter Real B[2, 1] = [0; 2];
  parameter Real C[1, 2] = [1, 0.5];
  parameter Real D[1, 1] = [0.25];
  input Real u(start = 3);
  Real x[2](start = {1, -1}, each fixed = true);
  Real w[1];
  output Real y;
equation
  der(x) = A * x + B * {u};
  w = C * x + D * {u};
  y = w[1];
end MatrixStateSpace;
