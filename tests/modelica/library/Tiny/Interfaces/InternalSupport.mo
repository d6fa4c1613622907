within Tiny.Interfaces;
model InternalSupport "Adapter model to utilize conditional support connector"
  input Units.Torque tau "External support torque (must be computed via torque balance in the model)";
  Units.Angle phi "External support angle (= flange.phi)";
  Flange_a flange "Internal support flange";
equation
  flange.tau = tau;
  flange.phi = phi;
end InternalSupport;
