within AdasPowertrain.Gearboxes;
model StepAutomatic
  "Torque converter with lock-up clutch before a stepped gearbox. With slip control, the clutch closes at lower speeds and
   keeps a small slip there: a proportional-integral controller sets its pressure (Hiramatsu et al., SAE 850459)"
  extends Interfaces.TwoFlanges;
  parameter Vehicles.GearboxData data;
  parameter Real initial_speed(unit = "rad/s", min = 0) = 0 "Of the output";
  parameter Real initial_slip(unit = "rad/s") = 0 "Engine speed beyond the input's";
  parameter Real max_power(unit = "W") "Full load, for the shift schedule";
  parameter Real lock_up_capacity(unit = "N.m") = 400;
  parameter Real lock_up_lag(unit = "s") = 0.15 "Time constant of its pressure";
  parameter Boolean has_slip_control = false;
  parameter Real wanted_slip(unit = "rad/s", min = 1) = 6;
  parameter Real slip_gain(unit = "s/rad", min = 1e-4) = 0.01 "Pressure per slip";
  parameter Real slip_time(unit = "s", min = 0.01) = 0.25 "Of the controller's integral part";
  parameter Real slip_from(unit = "rad/s") = 95 "Input speed from which the clutch slips";
  parameter Real full_from(unit = "rad/s") = 130 "Input speed from which it closes";
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
    closing_speed = if has_slip_control then slip_from else 130,
    opening_speed = if has_slip_control then slip_from - 15 else 105,
    starts_closed = starts_closed,
    gear = gear.schedule.gear,
    input_speed = wheel_speed*data.final_ratio*data.ratios[gear.schedule.gear]);
  final parameter Real initial_input_speed(unit = "rad/s") = initial_speed*data.ratios[gear.schedule.initial_gear];
  final parameter Boolean starts_closed =
    gear.schedule.initial_gear >= lock_up_schedule.from_gear and initial_input_speed > lock_up_schedule.closing_speed;
protected
  Real pressure(start = if starts_closed then 1 else 0, fixed = true) "0 to 1";
  Real wanted_pressure "0 to 1";
  Real too_much(unit = "rad/s") "Slip";
  Real learned(start = if starts_closed then 1 else 0, fixed = true) "Integral part of the slip control, 0 to 1";
  Boolean is_slipping(start = false, fixed = true) "Slip is kept";
equation
  connect(a, converter.a);
  connect(a, lock_up.a);
  connect(converter.b, gear.a);
  connect(lock_up.b, gear.a);
  connect(gear.b, b);
  too_much = lock_up.slip - wanted_slip;
  is_slipping = has_slip_control and lock_up_schedule.is_closed
    and lock_up_schedule.input_speed < (if pre(is_slipping) then full_from + 5 else full_from);
  wanted_pressure = if is_slipping then noEvent(min(1, max(0, learned + slip_gain*too_much)))
    elseif lock_up_schedule.is_closed then 1 else 0;
  der(learned) = if is_slipping then slip_gain/slip_time*noEvent(if learned > 1 then min(0, too_much) elseif learned < 0 then max(0, too_much) else too_much)
    else (wanted_pressure - learned)/lock_up_lag;
  lock_up_lag*der(pressure) = wanted_pressure - pressure;
  ratio = gear.schedule.ratio*converter.torque_ratio;
  loss_power = converter.loss_power + lock_up.loss_power + gear.loss_power;
  energy = gear.energy;
end StepAutomatic;
