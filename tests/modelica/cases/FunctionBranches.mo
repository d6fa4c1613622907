// if, elseif, else in a function; a variable assigned in some branches only; reassignment of a variable to itself.
model FunctionBranches
  function shape
    input Real x;
    output Real y;
  protected
    Real a;
  algorithm
    a := x;
    y := 0;
    if a > 2 then
      a := a - 2;
      y := a * a;
    elseif a > 1 then
      y := a;
    else
      a := -a;
    end if;
    y := y + 10 * a;
    if y > 15 then
      y := y + x;
    end if;
  end shape;
  output Real low;
  output Real middle;
  output Real high;
  input Real u(start = 0.5);
equation
  low = shape(u);
  middle = shape(u + 1);
  high = shape(u + 2.25);
end FunctionBranches;
