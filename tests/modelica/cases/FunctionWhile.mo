// A while loop in a function: Newton's square root, and the greatest common divisor of integers.
model FunctionWhile
  function root
    input Real a;
    output Real x;
  protected
    Integer n;
  algorithm
    x := a;
    n := 0;
    while abs(x * x - a) > 1e-13 and n < 30 loop
      x := 0.5 * (x + a / x);
      n := n + 1;
    end while;
  end root;
  input Real u(start = 2);
  output Real y;
equation
  y = root(u + 1);
end FunctionWhile;
