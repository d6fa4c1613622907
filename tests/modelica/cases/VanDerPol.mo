// Van der Pol's oscillator with steep flanks.
model VanDerPol
  parameter Real mu = 30;
  Real x(start = 2, fixed = true);
  Real v(start = 0, fixed = true);
  output Real y;
equation
  der(x) = v;
  der(v) = mu * (1 - x ^ 2) * v - x;
  y = x;
end VanDerPol;
