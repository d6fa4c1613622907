within Tiny.Rotational;
model Torque "Input signal acting as external torque on a flange"
  Interfaces.RealInput tau(unit = "N.m");
  Interfaces.Flange_b flange;
equation
  flange.tau = -tau;
end Torque;
