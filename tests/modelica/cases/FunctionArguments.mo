// Named arguments, default values that depend on other inputs, and calls in calls.
model FunctionArguments
  function gauss
    input Real x;
    input Real mean = 0;
    input Real width = 1 + mean;
    output Real y = exp(-((x - mean) / width) ^ 2);
  algorithm
  end gauss;
  function twice
    input Real x;
    output Real y;
  algorithm
    y := gauss(gauss(x, width = 2), 0.5);
  end twice;
  input Real u(start = 0.8);
  output Real a;
  output Real b;
  output Real c;
equation
  a = gauss(u);
  b = gauss(mean = 0.25, x = u);
  c = twice(u);
end FunctionArguments;
