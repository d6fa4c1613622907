within AdasPowertrain.Driveline;
model Wheels "The wheels of an axle: their speed is given, the torque on them is found"
  Interfaces.RotationalFlange flange;
  Interfaces.RealInput speed(unit = "rad/s");
  Interfaces.RealOutput torque(unit = "N.m") "Drives the wheels if > 0";
protected
  Real angle(unit = "rad", start = 0, fixed = true);
equation
  flange.phi = angle;
  der(angle) = speed;
  torque = flange.tau;
end Wheels;
