within AdasPowertrain.Driveline;
model RigidShaft "Shaft without mass that does not twist"
  extends Interfaces.TwoFlanges;
equation
  a.phi = b.phi;
  a.tau + b.tau = 0;
end RigidShaft;
