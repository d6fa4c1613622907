// zeros, ones, fill, linspace, ranges, concatenation, comprehensions and reductions.
model ArrayConstructors
  input Real u(start = 0.5);
  Real squares[4] = {u * i ^ 2 for i in 1:4};
  Real joined[5] = cat(1, {u}, squares);
  Real stacked[4, 2] = [squares, 2 * squares];
  Real table[2, 3] = {{u * (10 * i + j) for j in 1:3} for i in 1:2};
  output Real y[8];
equation
  y[1] = sum(zeros(3)) + sum(ones(2, 2)) + sum(fill(u, 3));
  y[2] = sum(linspace(0, u, 5));
  y[3] = joined[1] + joined[5];
  y[4] = stacked[3, 2];
  y[5] = table[2, 3] - table[1, 2];
  y[6] = product({i + u for i in 1:3});
  y[7] = max({u - i for i in 3:-1:1}) + min(squares);
  y[8] = size(stacked, 2) + size(stacked, 1) + size(joined, 1) * u;
end ArrayConstructors;
