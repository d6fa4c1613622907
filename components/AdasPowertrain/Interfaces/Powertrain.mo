within AdasPowertrain.Interfaces;
partial model Powertrain "From torque demand to the torques of both axles, with its energy balance"
  extends EnergyBalance;
  parameter Real initial_speed(unit = "rad/s", min = 0) = 0 "Of the wheels";
  RealInput torque_demand(unit = "N.m", start = 0) "At the wheels, both axles together; drives if > 0";
  RealInput wheel_speed_front(unit = "rad/s", start = initial_speed);
  RealInput wheel_speed_rear(unit = "rad/s", start = initial_speed);
  RealOutput torque_front(unit = "N.m") "On the wheels of the front axle";
  RealOutput torque_rear(unit = "N.m") "On the wheels of the rear axle";
equation
  wheel_power = torque_front*wheel_speed_front + torque_rear*wheel_speed_rear;
end Powertrain;
