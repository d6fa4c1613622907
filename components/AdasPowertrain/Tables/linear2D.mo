within AdasPowertrain.Tables;
function linear2D "Bilinear between the points"
  input Real x "Where along the rows";
  input Real y "Where along the columns";
  input Real xs[:] "Strictly increasing";
  input Real ys[:] "Strictly increasing";
  input Real zs[size(xs, 1), size(ys, 1)] "zs[i, j] at (xs[i], ys[j])";
  input Extrapolation extrapolation = Extrapolation.hold "Outside the axes";
  output Real z;
external "C" z = dse_table2(x, y, xs, size(xs, 1), ys, size(ys, 1), zs, 0, extrapolation);
end linear2D;
