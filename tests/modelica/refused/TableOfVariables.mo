model TableOfVariables
  function lookup
    input Real x;
    input Real xs[:];
    input Real ys[size(xs, 1)];
    output Real y;
    external "C" y = dse_table1(x, xs, size(xs, 1), ys, 0, 1);
  end lookup;
  Real height;
  output Real y;
equation
  height = 1 + time;
  y = lookup(time, {0, 1, 2}, {0, height, 3}); // refused: table
end TableOfVariables;
