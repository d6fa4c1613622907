// Relations that stand exactly on their boundary when the simulation starts.
model BoundaryAtStart
  Real x(start = 1, fixed = true);
  Real w(start = 1, fixed = true);
  discrete Integer n(start = 0, fixed = true);
  discrete Integer m(start = 0, fixed = true);
  discrete Integer k(start = 0, fixed = true);
  output Boolean strict;
  output Boolean loose;
  output Integer y[3];
  output Real z;
equation
  der(x) = 1;
  der(w) = -1;
  strict = x > 1;
  loose = w >= 1;
  when x > 1 then
    n = pre(n) + 1;
  end when;
  when x >= 1 then
    m = pre(m) + 1;
  end when;
  when time >= 0 then
    k = pre(k) + 1;
  end when;
  y = {n, m, k};
  z = if w < 1 then 5 else 7;
end BoundaryAtStart;
