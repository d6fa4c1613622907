// An equation of columns, as of a multiplexer of vectors.
model ColumnEquation
  parameter Real k = 2;
  output Real y[3];
protected
  Real u1[1];
  Real u2[2];
equation
  u1 = {time};
  u2 = {k*time, time^2};
  [y] = [u1; u2];
end ColumnEquation;
