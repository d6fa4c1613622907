within AdasPowertrain.Tables;
function smooth1D "Monotone cubic Hermite spline with the slopes of Fritsch and Butland (SIAM J. Sci. Stat. Comput. 5, 1984)"
  input Real x "Where";
  input Real xs[:] "Strictly increasing";
  input Real ys[size(xs, 1)] "Values at xs";
  input Extrapolation extrapolation = Extrapolation.hold "Outside the axes";
  output Real y;
external "C" y = dse_table1(x, xs, size(xs, 1), ys, 1, extrapolation);
end smooth1D;
