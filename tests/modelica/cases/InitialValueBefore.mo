// Initial equations for the value before, and of values before, of discrete variables that nothing assigns at the start.
model InitialValueBefore
  discrete Real a(start = 3, fixed = true);
  discrete Real b;
  discrete Real d;
  discrete Real c(start = 0);
  Integer n(start = 5, fixed = true);
  output Real y[5];
initial equation
  pre(b) = 2 * a;
  d = pre(b) + pre(n);
equation
  when time > 0.5 then
    a = pre(a) + 1;
    b = pre(b) * 10;
    d = pre(d) - 1;
    n = pre(n) + 2;
  end when;
  when {initial(), time > 0.25} then
    c = 7 + time;
  end when;
  y = {a, b, c, n, d};
end InitialValueBefore;
