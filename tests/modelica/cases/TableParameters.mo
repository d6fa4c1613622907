// Entries of a table's axis and values changed from outside after the build.
package TableParameters
  function lookup
    input Real x;
    input Real xs[:];
    input Real ys[size(xs, 1)];
    input Integer smooth_curve;
    input Integer extrapolation;
    output Real y;
    external "C" y = dse_table1(x, xs, size(xs, 1), ys, smooth_curve, extrapolation);
  end lookup;
  model Test
    parameter Real scale = 1;
    parameter Real xs[3] = {0, 1, 2};
    parameter Real ys[3] = {0, scale, 4};
    Real x(start = 0, fixed = true);
    output Real y;
    output Real z;
  equation
    der(x) = lookup(x, xs, ys, 0, 2) + 1;
    y = x;
    z = lookup(time, xs, ys, 0, 2);
  end Test;
end TableParameters;
