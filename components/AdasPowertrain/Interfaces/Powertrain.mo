within AdasPowertrain.Interfaces;
partial model Powertrain
  "From torque demand to the torques of both axles, with its energy balance:
   energy_in = energy_out + energy_loss + change of energy_stored"
  parameter Real initial_speed(unit = "rad/s", min = 0) = 0 "Of the wheels";
  RealInput torque_demand(unit = "N.m", start = 0) "At the wheels, both axles together; drives if > 0";
  RealInput wheel_speed_front(unit = "rad/s", start = initial_speed);
  RealInput wheel_speed_rear(unit = "rad/s", start = initial_speed);
  RealOutput torque_front(unit = "N.m") "On the wheels of the front axle";
  RealOutput torque_rear(unit = "N.m") "On the wheels of the rear axle";
  RealOutput power(unit = "W") "Drawn from fuel (lower heating value) and battery (chemical) together";
  RealOutput fuel_power(unit = "W");
  RealOutput battery_power(unit = "W") "Discharging if > 0";
  RealOutput co2(unit = "kg/s") "From the tank to the wheels";
  RealOutput energy_in(unit = "J", start = 0, fixed = true) "Out of the stores, since the start";
  RealOutput energy_out(unit = "J", start = 0, fixed = true) "To the wheels, since the start";
  RealOutput energy_loss(unit = "J", start = 0, fixed = true) "Turned into heat or used on board, since the start";
  RealOutput energy_stored(unit = "J") "In motion and elastic deformation of parts, now";
protected
  Real loss_power(unit = "W");
equation
  power = fuel_power + battery_power;
  der(energy_in) = power;
  der(energy_out) = torque_front*wheel_speed_front + torque_rear*wheel_speed_rear;
  der(energy_loss) = loss_power;
end Powertrain;
