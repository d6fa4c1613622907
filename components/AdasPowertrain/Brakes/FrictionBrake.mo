within AdasPowertrain.Brakes;
model FrictionBrake
  "Service brake of both axles: torque follows the demand with a lag; the car's model gives it its direction"
  parameter Real lag(unit = "s", min = 1e-3, max = 1) = 0.1 "Time constant of the build-up";
  parameter Real max_torque(unit = "N.m", min = 0) = 5000 "Total at the wheels";
  parameter Real front_share(min = 0, max = 1) = 0.65 "Share of the front axle";
  Interfaces.RealInput torque_demand(unit = "N.m", start = 0) "Total at the wheels, >= 0";
  Interfaces.RealInput wheel_speed_front(unit = "rad/s", start = 0);
  Interfaces.RealInput wheel_speed_rear(unit = "rad/s", start = 0);
  Interfaces.RealOutput torque_front(unit = "N.m") ">= 0, against the rotation";
  Interfaces.RealOutput torque_rear(unit = "N.m") ">= 0, against the rotation";
  Interfaces.RealOutput power(unit = "W") "Turned into heat";
protected
  Real torque(unit = "N.m", start = 0, fixed = true);
equation
  lag*der(torque) = min(max_torque, max(0, torque_demand)) - torque;
  torque_front = front_share*torque;
  torque_rear = (1 - front_share)*torque;
  power = torque_front*abs(wheel_speed_front) + torque_rear*abs(wheel_speed_rear);
end FrictionBrake;
