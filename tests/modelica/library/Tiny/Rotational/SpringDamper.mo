within Tiny.Rotational;
model SpringDamper "Linear 1D rotational spring and damper in parallel"
  extends Interfaces.PartialCompliant;
  parameter Units.SpringConstant c(final min = 0, start = 1.0e5);
  parameter Units.DampingConstant d(final min = 0, start = 0);
  Units.AngularVelocity w_rel(start = 0);
equation
  w_rel = der(phi_rel);
  tau = c * phi_rel + d * w_rel;
end SpringDamper;
