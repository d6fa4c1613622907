// Equations in nested for loops over arrays whose sizes are constants; a triangular sum.
model ForEquations
  constant Integer n = 4;
  input Real u(start = 1.5);
  Real q[n, n];
  Real r[n];
  output Real total;
equation
  for i in 1:n loop
    for j in 1:n loop
      q[i, j] = if j <= i then u * i / j else 0;
    end for;
    r[i] = sum(q[i, :]);
  end for;
  total = sum(r[k] for k in 1:2:n);
end ForEquations;
