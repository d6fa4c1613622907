// fails: table
package TableLeft
  function lookup
    input Real x;
    input Real xs[:];
    input Real ys[size(xs, 1)];
    output Real y;
    external "C" y = dse_table1(x, xs, size(xs, 1), ys, 0, 3);
  end lookup;
  model Test
    Real x(start = 0, fixed = true);
    output Real y;
  equation
    der(x) = 1;
    y = lookup(x, {0, 0.5}, {1, 2});
  end Test;
end TableLeft;
