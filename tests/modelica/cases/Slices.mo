// Ranges and whole dimensions as indices, end, and vectors of indices.
model Slices
  parameter Real q[3, 4] = [1, 2, 3, 4; 5, 6, 7, 8; 9, 10, 11, 12];
  input Real u(start = -1);
  Real row[4] = q[2, :] * u;
  Real column[3] = q[:, end];
  Real part[2, 2] = q[2:3, {1, 4}];
  output Real a;
  output Real b;
  output Real c;
equation
  a = sum(row[2:end]) + row[end - 1];
  b = column * {1, 10, 100};
  c = part[1, 2] - u * part[end, 1];
end Slices;
