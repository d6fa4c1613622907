model EndlessFunction
  function f
    input Real x;
    output Real y;
  algorithm
    y := x;
    for i in 1:1000000 loop
      y := y + sin(y) / i;
    end for;
  end f;
  input Real u(start = 1);
  output Real y;
equation
  y = f(u); // refused: unroll
end EndlessFunction;
