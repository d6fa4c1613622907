// A function that calls itself, to a depth that a constant gives.
model RecursiveFunction
  function power
    input Real x;
    input Integer n;
    output Real y;
  algorithm
    y := if n <= 0 then 1 else x * power(x, n - 1);
  end power;
  input Real u(start = 2);
  output Real y;
equation
  y = power(u, 3);
end RecursiveFunction;
