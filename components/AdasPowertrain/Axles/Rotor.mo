within AdasPowertrain.Axles;
model Rotor "Inertia with a given torque on it, at the end of a shaft"
  parameter Real inertia(unit="kg.m2", min=1e-4, max=1) = 0.05;
  Interfaces.RotationalFlange flange;
  Interfaces.RealInput torque(unit="N.m") "Drives it";
  Interfaces.RealOutput speed(unit="rad/s");
  Interfaces.RealOutput kinetic_energy(unit="J");
initial equation
  flange.phi = 0;
equation
  speed = der(flange.phi);
  inertia * der(speed) = torque + flange.tau;
  kinetic_energy = 0.5 * inertia * speed ^ 2;
end Rotor;
