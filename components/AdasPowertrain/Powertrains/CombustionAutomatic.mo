within AdasPowertrain.Powertrains;
model CombustionAutomatic "Petrol engine, six-speed automatic with torque converter, compliant shafts to the front axle"
  extends Interfaces.Powertrain;
  parameter Vehicles.TurboPetrol15 engine_data;
  parameter Vehicles.SixSpeedAutomatic gearbox_data(final_ratio = final_ratio, shift_time = shift_time);
  parameter Vehicles.Fuel fuel;
  parameter Boolean is_cold = false "The engine starts at initial_temperature; else it is warm";
  parameter Real initial_temperature(unit = "K", min = 230, max = 400) = 296.15 "Of a cold engine";
  parameter Boolean has_stop_start = false "The engine stops at standstill while nothing is demanded";
  parameter Real engine_scale(min = 0.3, max = 3) = 1 "Displacement and torque against the engine's data";
  parameter Real engine_inertia(unit = "kg.m2", min = 0.02, max = 1) = 0.15 "With flywheel or flexplate";
  parameter Real final_ratio(min = 2, max = 6) = 3.5;
  parameter Real shift_time(unit = "s", min = 0.05, max = 2) = 0.4;
  parameter Boolean has_slip_control = false "Of the lock-up clutch";
  parameter Real wanted_slip(unit = "rad/s", min = 1) = 6 "Of the lock-up clutch, with slip control";
  parameter Real shaft_stiffness(unit = "N.m/rad", min = 1e3, max = 20e3) = 3e3
    "Half shafts, tyre walls and mounts in series; stable with wheels of 2 kg.m2 coupled every 10 ms";
  parameter Real shaft_damping(unit = "N.m.s/rad", min = 0, max = 300) = 100 "Of the same";
  Engines.Dynamic engine(
    data = engine_data,
    fuel = fuel,
    scale = engine_scale,
    inertia = engine_inertia,
    is_cold = is_cold,
    initial_temperature = initial_temperature,
    has_stop_start = has_stop_start,
    may_stop = may_stop,
    initial_speed = if gearbox.starts_closed then gearbox.initial_input_speed
      else max(engine_data.idle_speed, gearbox.initial_input_speed));
  Gearboxes.StepAutomatic gearbox(
    has_slip_control = has_slip_control,
    wanted_slip = wanted_slip,
    data = gearbox_data,
    initial_speed = initial_speed*final_ratio,
    max_power = engine_scale*engine_data.max_power,
    wheel_speed = wheel_speed_front,
    power_demand = torque_demand*wheel_speed_front);
  Driveline.Differential differential(ratio = final_ratio);
  Driveline.DriveShaft shaft(stiffness = shaft_stiffness, damping = shaft_damping);
  Driveline.Wheels wheels(speed = wheel_speed_front);
protected
  constant Real standing(unit = "rad/s") = 0.3 "Wheel speed below which the car stands";
  Boolean may_stop(start = false, fixed = true) "At standstill, until more is demanded than to creep";
equation
  may_stop = abs(wheel_speed_front) < standing and torque_demand < (if pre(may_stop) then 150 else 5);
  connect(engine.flange, gearbox.a);
  connect(gearbox.b, differential.a);
  connect(differential.b, shaft.a);
  connect(shaft.b, wheels.flange);
  engine.torque_demand = torque_demand/(final_ratio*gearbox_data.efficiency*gearbox.ratio);
  torque_front = wheels.torque;
  torque_rear = 0;
  fuel_power = engine.fuel_power;
  battery_power = engine.electric_power;
  co2 = engine.co2;
  loss_power = engine.loss_power + engine.starter_loss + gearbox.loss_power + shaft.loss_power;
  energy_stored = engine.energy + gearbox.energy + shaft.energy;
end CombustionAutomatic;
