within AdasPowertrain.Machines;
model Dynamic "Synchronous machine with inverter, torque lag and rotor between a shaft and a direct-current link"
  parameter Real rotor_inertia(unit="kg.m2", min=1e-4, max=1) = 0.05 "Of the rotor and what turns with it";
  Interfaces.RotationalFlange flange;
  Interfaces.DcLink link;
  Interfaces.RealInput torque_demand(unit="N.m");
  output Real loss(unit="W");
  output Real speed(unit="rad/s");
  output Real kinetic_energy(unit="J");
  Controlled control;
initial equation
  flange.phi = 0;
equation
  control.torque_demand = torque_demand;
  control.shaft_speed = speed;
  control.voltage = link.v;
  speed = der(flange.phi);
  rotor_inertia * der(speed) = control.torque + flange.tau;
  link.p = control.electric_power;
  loss = control.loss;
  kinetic_energy = 0.5 * rotor_inertia * speed ^ 2;
end Dynamic;
