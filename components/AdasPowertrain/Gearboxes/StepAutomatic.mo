within AdasPowertrain.Gearboxes;
model StepAutomatic "Torque converter with lock-up clutch before a stepped gearbox"
  extends Interfaces.TwoFlanges;
  parameter Vehicles.GearboxData data;
  parameter Real initial_speed(unit = "rad/s", min = 0) = 0 "Of the output";
  parameter Real initial_slip(unit = "rad/s") = 0 "Engine speed beyond the input's";
  parameter Real max_power(unit = "W") "Full load, for the shift schedule";
  parameter Real lock_up_capacity(unit = "N.m") = 400;
  parameter Real lock_up_lag(unit = "s") = 0.15 "Time constant of its pressure";
  Interfaces.RealInput wheel_speed(unit = "rad/s") "Driven axle";
  Interfaces.RealInput power_demand(unit = "W");
  Real ratio "Torque at the output against torque at the input, before losses";
  Real loss_power(unit = "W");
  Real energy(unit = "J") "Kinetic";
  Couplings.TorqueConverter converter;
  Couplings.Clutch lock_up(
    capacity = lock_up_capacity*pressure,
    initial_mode = if starts_closed then 0 elseif initial_slip < 0 then -1 else 1);
  SteppedGear gear(
    data = data,
    initial_speed = initial_speed,
    max_power = max_power,
    wheel_speed = wheel_speed,
    power_demand = power_demand);
  LockUpSchedule lock_up_schedule(
    starts_closed = starts_closed,
    gear = gear.schedule.gear,
    input_speed = wheel_speed*data.final_ratio*data.ratios[gear.schedule.gear]);
  final parameter Real initial_input_speed(unit = "rad/s") = initial_speed*data.ratios[gear.schedule.initial_gear];
  final parameter Boolean starts_closed =
    gear.schedule.initial_gear >= lock_up_schedule.from_gear and initial_input_speed > lock_up_schedule.closing_speed;
protected
  Real pressure(start = if starts_closed then 1 else 0, fixed = true) "0 to 1";
equation
  connect(a, converter.a);
  connect(a, lock_up.a);
  connect(converter.b, gear.a);
  connect(lock_up.b, gear.a);
  connect(gear.b, b);
  lock_up_lag*der(pressure) = (if lock_up_schedule.is_closed then 1 else 0) - pressure;
  ratio = gear.schedule.ratio*converter.torque_ratio;
  loss_power = converter.loss_power + lock_up.loss_power + gear.loss_power;
  energy = gear.energy;
end StepAutomatic;
