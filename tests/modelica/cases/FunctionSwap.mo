// Order of assignments: a swap through a temporary, and an element read after it was written.
model FunctionSwap
  function turned
    input Real v[3];
    output Real w[3];
  protected
    Real t;
  algorithm
    w := v;
    t := w[1];
    w[1] := w[3];
    w[3] := t;
    for i in 2:3 loop
      w[i] := w[i] + w[i - 1];
    end for;
  end turned;
  input Real u(start = 2);
  output Real y[3];
equation
  y = turned({u, 10, 100 * u});
end FunctionSwap;
