// An input with a value in its declaration has that value: it is no input from outside.
model InputWithDefault
  input Real u = 3;
  output Real y;
equation
  y = u;
end InputWithDefault;
