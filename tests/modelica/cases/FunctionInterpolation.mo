// A table written in Modelica: search in an algorithm with break, then a straight line.
model FunctionInterpolation
  function table
    input Real x;
    input Real xs[:];
    input Real ys[size(xs, 1)];
    output Real y;
  protected
    Integer k;
  algorithm
    k := 1;
    for i in 2:size(xs, 1) - 1 loop
      if x >= xs[i] then
        k := i;
      end if;
    end for;
    y := ys[k] + (ys[k + 1] - ys[k]) * (x - xs[k]) / (xs[k + 1] - xs[k]);
  end table;
  parameter Real xs[4] = {0, 1, 3, 4};
  parameter Real ys[4] = {0, 2, -2, 6};
  output Real y;
  Real x;
equation
  x = 5 * time - 0.5;
  y = table(x, xs, ys);
end FunctionInterpolation;
