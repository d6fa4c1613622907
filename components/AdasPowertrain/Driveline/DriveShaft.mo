within AdasPowertrain.Driveline;
model DriveShaft
  "Shaft that twists, with damping. Coupled to wheels of inertia J outside by torque and speed held over h, it is stable
   even if they spin freely for a < b*(1 - b), where a = stiffness*h^2/J, b = damping*h/J"
  extends Interfaces.TwoFlanges;
  parameter Real stiffness(unit = "N.m/rad", min = 0);
  parameter Real damping(unit = "N.m.s/rad", min = 0);
  Real twist(unit = "rad", start = 0, fixed = true) "Of end a against end b";
  Real torque(unit = "N.m") "From a to b";
  Real loss_power(unit = "W") "Into the damping";
  Real energy(unit = "J") "Elastic";
protected
  Real slip(unit = "rad/s");
equation
  // Speeds, not angles: the difference of two angles that grow with the way would lose digits.
  slip = der(a.phi) - der(b.phi);
  der(twist) = slip;
  torque = stiffness*twist + damping*slip;
  a.tau = torque;
  b.tau = -torque;
  loss_power = damping*slip*slip;
  energy = 0.5*stiffness*twist*twist;
end DriveShaft;
