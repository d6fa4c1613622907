within AdasPowertrain.Tables;
function linear1D "Straight lines between the points"
  input Real x "Where";
  input Real xs[:] "Strictly increasing";
  input Real ys[size(xs, 1)] "Values at xs";
  input Extrapolation extrapolation = Extrapolation.hold "Outside the axes";
  output Real y;
external "C" y = dse_table1(x, xs, size(xs, 1), ys, 0, extrapolation);
end linear1D;
