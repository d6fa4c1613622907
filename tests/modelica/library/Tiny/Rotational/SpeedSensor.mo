within Tiny.Rotational;
model SpeedSensor "Ideal sensor to measure the absolute flange angular velocity"
  Interfaces.Flange_a flange;
  Interfaces.RealOutput w(unit = "rad/s");
equation
  w = der(flange.phi);
  0 = flange.tau;
end SpeedSensor;
