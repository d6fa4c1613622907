within Tiny.Interfaces;
partial model PartialCompliant "Between two flanges, without inertia"
  Units.Angle phi_rel(start = 0, stateSelect = StateSelect.prefer) "Relative rotation angle";
  Units.Torque tau "Torque between flanges";
  Flange_a flange_a;
  Flange_b flange_b;
equation
  phi_rel = flange_b.phi - flange_a.phi;
  flange_b.tau = tau;
  flange_a.tau = -tau;
end PartialCompliant;
