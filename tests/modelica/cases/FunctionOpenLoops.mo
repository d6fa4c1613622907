// Loops by while: left by break, in a branch, and by return.
model FunctionOpenLoops
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
  function interval
    input Real c;
    output Real lo;
    output Real hi;
  protected
    Real alpha = 1.0;
    Real residue;
  algorithm
    lo := 0;
    residue := 5 - c*alpha;
    if residue < 0 then
      hi := alpha;
    else
      while residue >= 0 loop
        alpha := 1.5*alpha;
        residue := 5 - c*alpha;
      end while;
      hi := alpha;
    end if;
  end interval;
  function search "left by return and by break"
    input Real x;
    output Real n;
  algorithm
    n := 0;
    while n < 50 loop
      n := n + 1;
      if n*n > x then
        return;
      elseif n >= 6 then
        break;
      end if;
    end while;
    n := -1;
  end search;
  output Real y = f(time);
  output Real lo;
  output Real hi;
  output Real n = search(60*time);
equation
  (lo, hi) = interval(1 + time);
end FunctionOpenLoops;
