model BreakInWhile // refused: loop
  function f
    input Real x;
    output Real y;
  algorithm
    y := 0;
    while true loop
      y := y + 1;
      if y > x then
        break;
      end if;
    end while;
  end f;
  input Real u(start = 1);
  output Real y;
equation
  y = f(u);
end BreakInWhile;
