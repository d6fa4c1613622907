within AdasPowertrain.Tables;
function smooth2D "Cubic Hermite splines with parabolic slopes, first along y, then along x"
  input Real x "Where along the rows";
  input Real y "Where along the columns";
  input Real xs[:] "Strictly increasing";
  input Real ys[:] "Strictly increasing";
  input Real zs[size(xs, 1), size(ys, 1)] "zs[i, j] at (xs[i], ys[j])";
  input Extrapolation extrapolation = Extrapolation.hold "Outside the axes";
  output Real z;
external "C" z = dse_table2(x, y, xs, size(xs, 1), ys, size(ys, 1), zs, 1, extrapolation);
end smooth2D;
