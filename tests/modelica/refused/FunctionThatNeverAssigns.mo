model FunctionThatNeverAssigns
  function f
    input Real x;
    output Real y;
  protected
    Real a;
  algorithm
    if x > 0 then
      a := x;
    end if;
    y := a; // refused: a
  end f;
  input Real u(start = 1);
  output Real y;
equation
  y = f(u);
end FunctionThatNeverAssigns;
