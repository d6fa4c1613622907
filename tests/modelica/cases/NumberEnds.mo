// Very large and very small numbers, numbers of seventeen digits, and the sign of zero.
model NumberEnds
  constant Real tiny = 4.9406564584124654e-300;
  constant Real huge = 1.7976931348623157e+308;
  constant Real third = 0.33333333333333331;
  input Real u(start = 1);
  output Real y[5];
equation
  y[1] = tiny * 1e299 * u;
  y[2] = huge * u;
  y[3] = third * u;
  y[4] = 123456789012345678 * u;
  y[5] = 1E+3 * u + .5e1 + 2.E0;
end NumberEnds;
