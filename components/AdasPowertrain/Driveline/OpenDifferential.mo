within AdasPowertrain.Driveline;
model OpenDifferential "Final drive and bevel gears without mass: both wheels get the same torque, whatever they turn at"
  extends Interfaces.ThreeFlanges;
  parameter Real ratio(min = 0) "Turns of a per mean turn of the wheels";
  parameter Real initial_speed(unit = "rad/s") = 0 "Of the wheels";
  Real slip(unit = "rad/s") "Of the left wheel against the right one";
  Real carrier_torque(unit = "N.m") "On both wheels together";
  Real loss_power(unit = "W");
  Real energy(unit = "J");
equation
  a.phi = 0.5*ratio*(left.phi + right.phi);
  carrier_torque = ratio*a.tau;
  left.tau = -0.5*carrier_torque;
  right.tau = -0.5*carrier_torque;
  slip = der(left.phi) - der(right.phi);
  loss_power = 0;
  energy = 0;
end OpenDifferential;
