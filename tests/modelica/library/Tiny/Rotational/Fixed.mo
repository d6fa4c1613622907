within Tiny.Rotational;
model Fixed "Flange fixed in housing at a given angle"
  parameter Units.Angle phi0 = 0;
  Interfaces.Flange_b flange;
equation
  flange.phi = phi0;
end Fixed;
