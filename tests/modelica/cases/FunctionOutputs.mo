// Several outputs: all taken, some left out, only the first; matrices and vectors among them.
model FunctionOutputs
  function split
    input Real x;
    output Real whole;
    output Real rest;
    output Real list[2];
  algorithm
    whole := 3 * x;
    rest := x - 1;
    list := {whole + rest, whole * rest};
  end split;
  input Real u(start = 4);
  Real a;
  Real b;
  Real l[2];
  Real r;
  Real m[2];
  output Real y;
  output Real z;
equation
  (a, b, l) = split(u);
  (r, , m) = split(2 * u);
  y = a + 10 * b + 100 * l[1] + 1000 * l[2];
  z = r + split(u / 2) + m[1];
end FunctionOutputs;
