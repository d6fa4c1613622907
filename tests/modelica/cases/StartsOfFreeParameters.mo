// Starts of discrete variables by a parameter that an initial equation determines; one is assigned at the start.
model StartsOfFreeParameters
  parameter Real scale = 2;
  parameter Integer p(fixed = false);
  parameter Integer twice = 2 * p;
  Integer n(start = p, fixed = true);
  Integer m(start = twice, fixed = true);
  discrete Real d;
  discrete Real e(start = 0, fixed = true);
  output Real y[4] = {n, m, d, e};
initial equation
  p = if scale < 3 then 5 else 7;
  d = scale * p + 0.5;
equation
  when sample(0.5, 0.5) then
    n = pre(n) + 1;
    d = pre(d) + 1;
  end when;
  when {initial(), sample(0.5, 0.5)} then
    m = pre(m) + 1;
    e = pre(d) + pre(n);
  end when;
end StartsOfFreeParameters;
