within Tiny.Rotational;
model Inertia "1D-rotational component with inertia"
  Interfaces.Flange_a flange_a "Left flange of shaft";
  Interfaces.Flange_b flange_b "Right flange of shaft";
  parameter Units.Inertia J(min = 0, start = 1) "Moment of inertia";
  parameter StateSelect stateSelect = StateSelect.default annotation(HideResult = true);
  Units.Angle phi(stateSelect = stateSelect);
  Units.AngularVelocity w(stateSelect = stateSelect);
  Units.AngularAcceleration a;
equation
  phi = flange_a.phi;
  phi = flange_b.phi;
  w = der(phi);
  a = der(w);
  J * a = flange_a.tau + flange_b.tau;
end Inertia;
