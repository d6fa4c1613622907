// fails: SingularCoefficient.mo
model SingularCoefficient
  Real a;
  Real b;
  output Real y;
equation
  a + b = 1;
  a + (if time < 0.5 then 2 else 1) * b = 3;
  y = a;
end SingularCoefficient;
