model ExternalFunction
  function f
    input Real x;
    output Real y;
    external "C" y = my_sine(x);
  end f;
  input Real u(start = 1);
  output Real y;
equation
  y = f(u); // refused: my_sine
end ExternalFunction;
