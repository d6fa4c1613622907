// fails at the start: axis
package TableAxisSet
  function lookup
    input Real x;
    input Real xs[:];
    input Real ys[size(xs, 1)];
    output Real y;
    external "C" y = dse_table1(x, xs, size(xs, 1), ys, 0, 1);
  end lookup;
  model Test
    parameter Real middle = 5;
    parameter Real xs[3] = {0, middle, 2};
    output Real y;
  equation
    y = lookup(time, xs, {1, 2, 3});
  end Test;
end TableAxisSet;
