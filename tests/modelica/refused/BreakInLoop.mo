model BreakInLoop // refused: loop
  function f
    input Real x;
    output Real y;
  algorithm
    y := 0;
    for i in 1:5 loop
      y := y + i;
      if y > x then
        break;
      end if;
    end for;
  end f;
  input Real u(start = 1);
  output Real y;
equation
  y = f(u);
end BreakInLoop;
