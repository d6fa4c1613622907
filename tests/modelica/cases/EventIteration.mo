// Discrete equations that need several passes: a counter that counts itself up to a limit within one instant.
model EventIteration
  Integer n(start = 0, fixed = true);
  Boolean go;
  output Integer y;
  output Boolean full;
equation
  go = time >= 0.5;
  n = if go and pre(n) < 7 then pre(n) + 1 else pre(n);
  y = n;
  full = n == 7;
end EventIteration;
