within AdasPowertrain.Powertrains;
partial model CombustionDualClutchByWheel
  "Petrol engine, seven-speed dual-clutch gearbox, differential and two half shafts to the front wheels"
  extends Interfaces.WheelPowertrain;
  parameter Vehicles.TurboPetrol15 engine_data;
  parameter Vehicles.SevenSpeedDualClutch gearbox_data(final_ratio = final_ratio, shift_time = shift_time);
  parameter Vehicles.Fuel fuel;
  parameter Real engine_scale(min = 0.3, max = 3) = 1 "Displacement and torque against the engine's data";
  parameter Real engine_inertia(unit = "kg.m2", min = 0.02, max = 1) = 0.15 "With flywheel or flexplate";
  parameter Real final_ratio(min = 2, max = 6) = 4.438;
  parameter Real shift_time(unit = "s", min = 0.05, max = 2) = 0.25;
  parameter Real shaft_stiffness(unit = "N.m/rad", min = 1e3, max = 60e3) = 30e3 "Of each half shaft";
  parameter Real shaft_damping(unit = "N.m.s/rad", min = 0, max = 600) = 150 "Of each half shaft";
  Engines.Dynamic engine(
    data = engine_data,
    fuel = fuel,
    scale = engine_scale,
    inertia = engine_inertia,
    initial_speed = max(engine_data.idle_speed, gearbox.initial_input_speed));
  Gearboxes.DualClutch gearbox(
    data = gearbox_data,
    initial_speed = initial_speed*final_ratio,
    max_power = engine_scale*engine_data.max_power,
    starts_locked = gearbox.initial_input_speed >= engine_data.idle_speed,
    wheel_speed = wheel_speed,
    power_demand = torque_demand*wheel_speed);
  replaceable Driveline.OpenDifferential differential(ratio = final_ratio, initial_speed = initial_speed);
  Driveline.HalfShafts shafts(
    stiffness = shaft_stiffness,
    damping = shaft_damping,
    speed_left = wheel_speeds[1],
    speed_right = wheel_speeds[2]);
protected
  Real wheel_speed(unit = "rad/s") "Mean of the front wheels";
equation
  connect(engine.flange, gearbox.a);
  connect(gearbox.b, differential.a);
  connect(differential.left, shafts.a);
  connect(differential.right, shafts.b);
  wheel_speed = 0.5*(wheel_speeds[1] + wheel_speeds[2]);
  engine.torque_demand = torque_demand/(final_ratio*gearbox_data.efficiency*gearbox.ratio);
  wheel_torque = {shafts.torque_left, shafts.torque_right, 0, 0};
  fuel_power = engine.fuel_power;
  battery_power = 0;
  co2 = engine.co2;
  loss_power = engine.loss_power + gearbox.loss_power + differential.loss_power + shafts.loss_power;
  energy_stored = engine.energy + gearbox.energy + differential.energy + shafts.energy;
end CombustionDualClutchByWheel;
