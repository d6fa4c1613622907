within AdasPowertrain.Driveline;
model TorqueSource "Something that turns a shaft"
  Interfaces.RotationalFlange flange;
  Interfaces.RealInput torque(unit = "N.m") "Drives the shaft if > 0";
equation
  flange.tau = -torque;
end TorqueSource;
