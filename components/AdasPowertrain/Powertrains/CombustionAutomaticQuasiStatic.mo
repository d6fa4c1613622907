within AdasPowertrain.Powertrains;
model CombustionAutomaticQuasiStatic
  "As CombustionAutomatic, without inertias, lags and elasticity: torques follow the demand at once. With the converter
   open the engine runs where the pump's torque would be the demanded one (the quadratic curve of Kotwicki, solved for the
   pump's speed), and never below idle"
  extends Interfaces.Powertrain;
  parameter Vehicles.TurboPetrol15 engine_data;
  parameter Vehicles.SixSpeedAutomatic gearbox_data(final_ratio = final_ratio, shift_time = shift_time);
  parameter Vehicles.Fuel fuel;
  parameter Real engine_scale(min = 0.3, max = 3) = 1 "Displacement and torque against the engine's data";
  parameter Real final_ratio(min = 2, max = 6) = 3.5;
  parameter Real shift_time(unit = "s", min = 0.05, max = 2) = 0.4;
  Engines.TorqueMap engine(data = engine_data, fuel = fuel, scale = engine_scale);
  Gearboxes.ShiftSchedule schedule(
    data = gearbox_data,
    initial_speed = initial_speed*final_ratio,
    max_power = engine_scale*engine_data.max_power,
    output_speed = wheel_speed_front*final_ratio,
    power = torque_demand*wheel_speed_front);
  Gearboxes.LockUpSchedule lock_up(
    starts_closed = schedule.initial_gear >= lock_up.from_gear
      and initial_speed*final_ratio*gearbox_data.ratios[schedule.initial_gear] > lock_up.closing_speed,
    gear = schedule.gear,
    input_speed = turbine_speed);
protected
  constant Real standing(unit = "rad/s") = 1 "Losses against the rotation fall to zero below";
  constant Real a0 = 3.4325e-3 "Of the pump torque a0*p^2 + a1*p*t - a2*t^2 at the speeds p and t of pump and turbine";
  constant Real a1 = 2.2210e-3;
  constant Real a2 = 4.6041e-3;
  Real ratio "Input of the gearbox against wheels";
  Real turbine_speed(unit = "rad/s");
  Real wanted(unit = "N.m") "By the driver, at the input of the gearbox";
  Real speed_ratio "Turbine against pump";
  Real creep(unit = "N.m") "Pump torque at idle";
  Real torque_ratio "Turbine against pump";
  Real turbine_torque(unit = "N.m");
  Real mesh(unit = "N.m") "Loss of the meshes, as torque at the input";
  Real drag(unit = "N.m");
equation
  ratio = schedule.ratio*final_ratio;
  turbine_speed = ratio*wheel_speed_front;
  wanted = max(0, torque_demand)/(ratio*gearbox_data.efficiency);
  engine.speed = max(max(engine_data.idle_speed, turbine_speed), if lock_up.is_closed then 0 else
    (sqrt(a1*a1*turbine_speed*turbine_speed + 4*a0*(a2*turbine_speed*turbine_speed + wanted)) - a1*turbine_speed)/(2*a0));
  speed_ratio = turbine_speed/engine.speed;
  torque_ratio = 1 + 0.68*max(0, 1 - max(0, speed_ratio)/0.9);
  creep = max(0, 1 - speed_ratio)*a0*engine_data.idle_speed*engine_data.idle_speed;
  engine.torque_demand = max(creep, wanted/torque_ratio);
  turbine_torque = torque_ratio*engine.torque;
  mesh = (1 - gearbox_data.efficiency)*abs(turbine_torque)*Smooth.direction(turbine_speed, standing);
  drag = gearbox_data.drag*Smooth.direction(turbine_speed, standing);
  torque_front = ratio*(turbine_torque - mesh - drag);
  torque_rear = 0;
  fuel_power = engine.fuel_power;
  battery_power = 0;
  co2 = engine.co2;
  loss_power = engine.loss_power + (engine.torque*engine.speed - turbine_torque*turbine_speed) + (mesh + drag)*turbine_speed;
  energy_stored = 0;
end CombustionAutomaticQuasiStatic;
