within AdasPowertrain.Gearboxes;
model FixedRatio "One pair of gears with the inertia of its input and mesh losses"
  extends Interfaces.TwoFlanges;
  parameter Real ratio(min = 0) "Turns of a per turn of b";
  parameter Real efficiency(min = 0, max = 1) "Per torque";
  parameter Real inertia(unit = "kg.m2", min = 0) "At the input";
  parameter Real initial_speed(unit = "rad/s") = 0 "Of the input";
  Real speed(unit = "rad/s", start = initial_speed, fixed = true, stateSelect = StateSelect.prefer) "Of the input";
  Real loss_power(unit = "W");
  Real energy(unit = "J") "Kinetic";
protected
  constant Real standing(unit = "rad/s") = 1 "Losses fall to zero below";
  constant Real idling(unit = "N.m") = 1e-3 "No torque to speak of";
  Real torque(unit = "N.m") "Into the gears";
  Boolean is_driving(start = true, fixed = true) "The input drives the output";
  Real mesh(unit = "N.m");
equation
  speed = der(a.phi);
  a.phi = ratio*b.phi;
  is_driving = torque > (if pre(is_driving) then -idling else idling);
  mesh = (1 - efficiency)*(if is_driving then torque else -torque)*Smooth.direction(speed, standing);
  inertia*der(speed) = a.tau - torque;
  ratio*(torque - mesh) + b.tau = 0;
  loss_power = mesh*speed;
  energy = 0.5*inertia*speed*speed;
end FixedRatio;
