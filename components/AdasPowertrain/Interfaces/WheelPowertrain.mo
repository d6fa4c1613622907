within AdasPowertrain.Interfaces;
partial model WheelPowertrain
  "From torque demand to the torque of each wheel, with its energy balance: front left, front right, rear left, rear right"
  extends EnergyBalance;
  parameter Real initial_speed(unit = "rad/s", min = 0) = 0 "Of the wheels";
  RealInput torque_demand(unit = "N.m", start = 0) "At the wheels, all together; drives if > 0";
  RealInput wheel_speeds[4](each unit = "rad/s", each start = initial_speed);
  RealOutput wheel_torque[4](each unit = "N.m") "On each wheel";
equation
  wheel_power = wheel_torque*wheel_speeds;
end WheelPowertrain;
