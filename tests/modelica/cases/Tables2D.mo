// Two-dimensional tables: bilinear and smooth, each kind of extrapolation, over a path that leaves the grid on all sides.
package Tables2D
  function lookup
    input Real x;
    input Real y;
    input Real xs[:];
    input Real ys[:];
    input Real zs[size(xs, 1), size(ys, 1)];
    input Integer smooth_surface;
    input Integer extrapolation;
    output Real z;
    external "C" z = dse_table2(x, y, xs, size(xs, 1), ys, size(ys, 1), zs, smooth_surface, extrapolation);
  end lookup;
  model Test
    parameter Real xs[3] = {0, 1, 3};
    parameter Real ys[4] = {-1, 0, 2, 3};
    parameter Real zs[3, 4] = [1, 2, 0, 5; -1, 3, 4, 1; 2, 2, -3, 0];
    Real x;
    Real y;
    output Real z[4];
  equation
    x = 1.5 + 2.5 * cos(6.283185307179586 * time);
    y = 1 + 3 * sin(6.283185307179586 * time);
    z[1] = lookup(x, y, xs, ys, zs, 0, 1);
    z[2] = lookup(x, y, xs, ys, zs, 0, 2);
    z[3] = lookup(x, y, xs, ys, zs, 1, 1);
    z[4] = lookup(x, y, xs, ys, zs, 1, 2);
  end Test;
end Tables2D;
