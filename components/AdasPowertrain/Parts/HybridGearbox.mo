within AdasPowertrain.Parts;
model HybridGearbox
  "P2 hybrid's mechanics: engine - separating clutch K0 - machine - seven-speed dual-clutch gearbox - front axle. The
   machine always turns with the gearbox; the car drives off by machine, or by engine while K0 slips"
  parameter Vehicles.SevenSpeedDualClutch gearbox_data(final_ratio = final_ratio, inertia_in = machine_inertia + 0.02);
  parameter Real initial_speed(unit = "rad/s", min = 0) = 0 "Of the wheels";
  parameter Real initial_engine_speed(unit = "rad/s", min = 0) = 0;
  parameter Real final_ratio(min = 2, max = 6) = 4.438;
  parameter Real engine_inertia(unit = "kg.m2", min = 0.02, max = 1) = 0.15 "With its flywheel";
  parameter Real machine_inertia(unit = "kg.m2", min = 0, max = 1) = 0.05 "Rotor and clutch drums";
  parameter Real clutch_capacity(unit = "N.m", min = 0, max = 2000) = 400 "K0, closed";
  parameter Real clutch_lag(unit = "s", min = 0.005, max = 1) = 0.05 "Time constant of K0's actuator";
  parameter Real max_power(unit = "W", min = 1e3, max = 1e6) = 130e3 "At which the gears are used to the full";
  parameter Real shaft_stiffness(unit = "N.m/rad", min = 1e3, max = 20e3) = 3e3
    "Half shafts, tyre walls and mounts in series; stable with wheels of 2 kg.m2 coupled every 10 ms";
  parameter Real shaft_damping(unit = "N.m.s/rad", min = 0, max = 300) = 100 "Of the same";
  Interfaces.RealInput engine_torque(unit = "N.m", start = 0);
  Interfaces.RealInput machine_torque(unit = "N.m", start = 0);
  Interfaces.RealInput clutch(start = 0) "K0, 0 open to 1 closed";
  Interfaces.RealInput wheel_speed_front(unit = "rad/s", start = initial_speed);
  Interfaces.RealInput wheel_speed_rear(unit = "rad/s", start = initial_speed);
  Interfaces.RealOutput engine_speed(unit = "rad/s");
  Interfaces.RealOutput machine_speed(unit = "rad/s");
  Interfaces.RealOutput torque_front(unit = "N.m") "On the wheels of the front axle";
  Interfaces.RealOutput torque_rear(unit = "N.m") "On the wheels of the rear axle";
  output Integer gear;
  Interfaces.RealOutput ratio "Machine against wheels";
  Interfaces.RealOutput energy_in(unit = "J", start = 0, fixed = true) "Work of engine and machine, since the start";
  Interfaces.RealOutput energy_out(unit = "J", start = 0, fixed = true) "To the wheels, since the start";
  Interfaces.RealOutput energy_loss(unit = "J", start = 0, fixed = true) "Turned into heat, since the start";
  Interfaces.RealOutput energy_stored(unit = "J") "In motion and elastic deformation of parts, now";
  Driveline.TorqueSource combustion(torque = engine_torque);
  Driveline.TorqueSource electric(torque = machine_torque);
  Driveline.Inertia engine(inertia = engine_inertia, initial_speed = initial_engine_speed);
  Couplings.Clutch separator(
    capacity = clutch_capacity*pressure,
    initial_mode =
      if initial_engine_speed < initial_speed*final_ratio*gearbox_data.ratios[gearbox.schedule.initial_gear] then -1 else 1);
  Gearboxes.SteppedGear gearbox(
    data = gearbox_data,
    initial_speed = initial_speed*final_ratio,
    max_power = max_power,
    wheel_speed = wheel_speed_front,
    power_demand = drive_power);
  Driveline.Differential differential(ratio = final_ratio);
  Driveline.DriveShaft shaft(stiffness = shaft_stiffness, damping = shaft_damping);
  Driveline.Wheels wheels(speed = wheel_speed_front);
protected
  constant Real load_lag(unit = "s") = 0.3 "Shifts follow the torques with this time constant";
  Real pressure(start = 0, fixed = true) "Of K0, 0 to 1";
  Real drive_power(unit = "W", start = 0, fixed = true) "Of engine and machine";
  Real angle(unit = "rad", start = 0, fixed = true) "Of the engine";
equation
  angle = engine.a.phi;
  connect(combustion.flange, engine.a);
  connect(engine.b, separator.a);
  connect(electric.flange, gearbox.a);
  connect(separator.b, gearbox.a);
  connect(gearbox.b, differential.a);
  connect(differential.b, shaft.a);
  connect(shaft.b, wheels.flange);
  clutch_lag*der(pressure) = min(1, max(0, clutch)) - pressure;
  load_lag*der(drive_power) = engine_torque*engine_speed + machine_torque*machine_speed - drive_power;
  engine_speed = engine.speed;
  machine_speed = gearbox.input_speed;
  torque_front = wheels.torque;
  torque_rear = 0;
  gear = gearbox.schedule.gear;
  ratio = gearbox.schedule.ratio*final_ratio;
  der(energy_in) = engine_torque*engine_speed + machine_torque*machine_speed;
  der(energy_out) = torque_front*wheel_speed_front + torque_rear*wheel_speed_rear;
  der(energy_loss) = separator.loss_power + gearbox.loss_power + shaft.loss_power;
  energy_stored = engine.energy + gearbox.energy + shaft.energy;
end HybridGearbox;
