// One-dimensional tables: straight lines and smooth curves, each kind of extrapolation, axis and values are parameters.
package Tables1D
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
    parameter Real xs[5] = {-1, 0, 0.5, 2, 3};
    parameter Real ys[5] = {2, 0, 1, 1.5, -3};
    Real x;
    output Real y[4];
  equation
    x = 6 * time - 2;
    y[1] = lookup(x, xs, ys, 0, 1);
    y[2] = lookup(x, xs, ys, 0, 2);
    y[3] = lookup(x, xs, ys, 1, 1);
    y[4] = lookup(x, xs, ys, 1, 2);
  end Test;
end Tables1D;
