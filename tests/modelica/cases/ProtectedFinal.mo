// Protected and final things, final parameters that depend on others, modified from outside.
model ProtectedFinal
  block Gain
    parameter Real k = 1;
    input Real u;
    output Real y;
  protected
    final parameter Real k2 = k * k;
    Real inner_value = k2 * u;
  equation
    y = inner_value + k;
  end Gain;
  Gain a(final k = 3);
  Gain b(k = 2 * c, u = a.y);
  parameter Real c = 0.5;
  input Real u(start = 1);
  output Real y;
equation
  a.u = u;
  y = b.y;
end ProtectedFinal;
