within AdasPowertrain.Powertrains;
model CombustionDualClutch "Petrol engine, seven-speed dual-clutch gearbox, compliant shafts to the front axle"
  extends Interfaces.Powertrain;
  parameter Vehicles.TurboPetrol15 engine_data;
  parameter Vehicles.SevenSpeedDualClutch gearbox_data(final_ratio = final_ratio, shift_time = shift_time, torque_phase = torque_phase);
  parameter Vehicles.Fuel fuel;
  parameter Boolean is_cold = false "The engine starts at initial_temperature; else it is warm";
  parameter Real initial_temperature(unit = "K", min = 230, max = 400) = 296.15 "Of a cold engine";
  parameter Boolean has_stop_start = false "The engine stops at standstill while nothing is demanded";
  parameter Real engine_scale(min = 0.3, max = 3) = 1 "Displacement and torque against the engine's data";
  parameter Real engine_inertia(unit = "kg.m2", min = 0.02, max = 1) = 0.15 "With flywheel or flexplate";
  parameter Real final_ratio(min = 2, max = 6) = 4.438;
  parameter Real shift_time(unit = "s", min = 0.05, max = 2) = 0.25;
  parameter Real torque_phase(unit = "s", min = 0, max = 1) = 0.0 "Part of the shift in which the torque is handed over; 0: at once";
  parameter Real intervention_share(min = 0, max = 1) = 0 "Part of the torque that slows the engine in upshifts which its ignition takes over";
  parameter Boolean has_charger = false "The engine's torque follows the boost pressure of its turbocharger";
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
    has_charger = has_charger,
    intervention = gearbox.intervention,
    has_stop_start = has_stop_start,
    may_stop = may_stop,
    initial_speed = max(engine_data.idle_speed, gearbox.initial_input_speed));
  Gearboxes.DualClutch gearbox(
    data = gearbox_data,
    intervention_share = intervention_share,
    engine_inertia = engine_inertia,
    initial_speed = initial_speed*final_ratio,
    max_power = engine_scale*engine_data.max_power,
    starts_locked = gearbox.initial_input_speed >= engine_data.idle_speed,
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
end CombustionDualClutch;
