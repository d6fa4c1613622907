// In one instant: a state is set anew, a counter takes the value before, another when-clause sees the counter.
model ReinitAndWhen
  Real x(start = 0, fixed = true);
  discrete Real seen(start = -1, fixed = true);
  discrete Real last(start = -1, fixed = true);
  Integer n(start = 0, fixed = true);
  output Real y[4];
equation
  der(x) = 1;
  when x >= 0.3 then
    reinit(x, -0.1 * n);
    seen = pre(x);
    n = pre(n) + 1;
  end when;
  when n >= 2 then
    last = time;
  end when;
  y = {x, seen, last, n};
end ReinitAndWhen;
