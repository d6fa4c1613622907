package Combustion "Cars and benches around the combustion library, for comparison with models written from the physics"
  import AdasPowertrain.Driveline;
  import AdasPowertrain.Couplings;

  partial model Car "One mass on wheels that roll without slip"
    parameter Real mass = 1600;
    parameter Real radius = 0.31;
    parameter Real drag_area = 0.65;
    parameter Real rolling = 0.01;
    parameter Real initial_speed = 0;
    output Real speed(start = initial_speed, fixed = true);
    output Real position(start = 0, fixed = true);
    Real torque_demand;
    Real brake_torque;
    Real drive_torque;
  equation
    mass*der(speed) = drive_torque/radius - 0.5*1.2*drag_area*speed*abs(speed)
      - (rolling*mass*9.81 + brake_torque/radius)*tanh(speed/0.1);
    der(position) = speed;
  end Car;

  partial model PoweredCar
    extends Car;
    replaceable AdasPowertrain.Interfaces.Powertrain powertrain(initial_speed = initial_speed/radius);
  equation
    drive_torque = powertrain.torque_front + powertrain.torque_rear;
    powertrain.torque_demand = torque_demand;
    powertrain.wheel_speed_front = speed/radius;
    powertrain.wheel_speed_rear = speed/radius;
  end PoweredCar;

  partial model DemandOverTime "Through points, by a smooth curve"
    parameter Real times[10] = {0, 1, 3, 12, 13, 20, 21, 26, 28, 40};
    parameter Real demands[10] = {0, 0, 1500, 1500, 0, 0, 900, 900, 0, 0};
    Real torque_demand;
    Real brake_torque;
  equation
    torque_demand = AdasPowertrain.Tables.smooth1D(time, times, demands);
    brake_torque = 0;
  end DemandOverTime;

  partial model Driver "Follows a speed given from outside with its acceleration"
    extends Car;
    input Real target(start = 0);
    input Real target_acceleration(start = 0);
    parameter Real gain(unit = "N.m.s/m") = 2000;
  protected
    Real wanted(unit = "N.m");
  equation
    wanted = (mass*target_acceleration + 0.5*1.2*drag_area*speed*abs(speed) + rolling*mass*9.81*tanh(speed/0.1))*radius
      + gain*(target - speed);
    torque_demand = max(0, wanted);
    brake_torque = max(0, -wanted);
  end Driver;

  model Automatic
    extends PoweredCar(redeclare AdasPowertrain.Powertrains.CombustionAutomatic powertrain(initial_speed = initial_speed/radius));
    extends DemandOverTime;
  end Automatic;

  model DualClutch
    extends PoweredCar(redeclare AdasPowertrain.Powertrains.CombustionDualClutch powertrain(initial_speed = initial_speed/radius));
    extends DemandOverTime;
  end DualClutch;

  model QuasiStatic
    extends PoweredCar(redeclare AdasPowertrain.Powertrains.CombustionAutomaticQuasiStatic powertrain(initial_speed = initial_speed/radius));
    extends DemandOverTime;
  end QuasiStatic;

  model AutomaticCar "For a controller outside"
    extends PoweredCar(
      redeclare AdasPowertrain.Powertrains.CombustionAutomatic powertrain(initial_speed = initial_speed/radius),
      torque_demand = demand,
      brake_torque = brake);
    input Real demand(unit = "N.m", start = 0) "Torque demanded from the powertrain, at the wheels";
    input Real brake(unit = "N.m", start = 0) "Torque of the brakes";
  end AutomaticCar;

  model AutomaticOnCycle
    extends PoweredCar(redeclare AdasPowertrain.Powertrains.CombustionAutomatic powertrain(initial_speed = initial_speed/radius));
    extends Driver;
  end AutomaticOnCycle;

  model DualClutchOnCycle
    extends PoweredCar(redeclare AdasPowertrain.Powertrains.CombustionDualClutch powertrain(initial_speed = initial_speed/radius));
    extends Driver;
  end DualClutchOnCycle;

  model QuasiStaticOnCycle
    extends PoweredCar(redeclare AdasPowertrain.Powertrains.CombustionAutomaticQuasiStatic powertrain(initial_speed = initial_speed/radius));
    extends Driver;
  end QuasiStaticOnCycle;

  model HybridGearboxInCar "Torques of engine and machine and the clutch's position over time"
    extends Car;
    AdasPowertrain.Parts.HybridGearbox gearbox(initial_speed = initial_speed/radius);
    parameter Real times[10] = {0, 1, 2, 6, 7, 12, 13, 18, 20, 30};
    parameter Real engine_torques[10] = {0, 0, 0, 0, -15, 120, 120, 60, -20, -20};
    parameter Real machine_torques[10] = {0, 0, 100, 100, 60, 40, 80, -60, -60, 0};
    parameter Real positions[10] = {0, 0, 0, 0, 0.3, 1, 1, 1, 1, 0};
  equation
    torque_demand = 0;
    brake_torque = 0;
    gearbox.engine_torque = AdasPowertrain.Tables.smooth1D(time, times, engine_torques);
    gearbox.machine_torque = AdasPowertrain.Tables.smooth1D(time, times, machine_torques);
    gearbox.clutch = AdasPowertrain.Tables.smooth1D(time, times, positions);
    gearbox.wheel_speed_front = speed/radius;
    gearbox.wheel_speed_rear = speed/radius;
    drive_torque = gearbox.torque_front + gearbox.torque_rear;
  end HybridGearboxInCar;

  model ShaftBench "Two inertias, a rigid shaft, a differential and a shaft that twists"
    parameter Real torque = 30;
    Driveline.TorqueSource source(torque = torque);
    Driveline.Inertia first(inertia = 0.2);
    Driveline.RigidShaft rigid;
    Driveline.Differential differential(ratio = 4);
    Driveline.DriveShaft shaft(stiffness = 8000, damping = 120);
    Driveline.Inertia second(inertia = 5, initial_speed = 2);
    output Real twist = shaft.twist;
    output Real loss(start = 0, fixed = true);
    output Real energy = first.energy + second.energy + shaft.energy;
    Real angle_first(start = 0, fixed = true);
    Real angle_second(start = 0, fixed = true);
  equation
    angle_first = first.a.phi;
    angle_second = second.a.phi;
    connect(source.flange, first.a);
    connect(first.b, rigid.a);
    connect(rigid.b, differential.a);
    connect(differential.b, shaft.a);
    connect(shaft.b, second.a);
    der(loss) = shaft.loss_power;
  end ShaftBench;

  model ClutchBench "A driven inertia takes another one along: slips, holds, and slips again as the capacity fades"
    Driveline.TorqueSource source(torque = 50);
    Driveline.Inertia first(inertia = 0.5, initial_speed = 100);
    Couplings.Clutch clutch(capacity = max(0, 120 - 10*time));
    Driveline.Inertia second(inertia = 1.5);
    Driveline.TorqueSource load(torque = -20);
    output Integer mode = clutch.mode;
    output Real loss(start = 0, fixed = true);
    Real angle_first(start = 0, fixed = true);
    Real angle_second(start = 0, fixed = true);
  equation
    angle_first = first.a.phi;
    angle_second = second.a.phi;
    connect(source.flange, first.a);
    connect(first.b, clutch.a);
    connect(clutch.b, second.a);
    connect(load.flange, second.b);
    der(loss) = clutch.loss_power;
  end ClutchBench;

  model FixedRatioBench "Driven, then braked through a pair of gears"
    parameter Real torque = 40;
    Driveline.TorqueSource source(torque = torque*cos(time));
    AdasPowertrain.Gearboxes.FixedRatio gear(ratio = 9, efficiency = 0.96, inertia = 0.05, initial_speed = 50);
    Driveline.TorqueSource load(torque = -60);
    output Real loss(start = 0, fixed = true);
    Real angle(start = 0, fixed = true);
  equation
    angle = gear.a.phi;
    connect(source.flange, gear.a);
    connect(gear.b, load.flange);
    der(loss) = gear.loss_power;
  end FixedRatioBench;

  model ConverterBench "Both sides turned at given speeds"
    input Real pump_speed(start = 0);
    input Real turbine_speed(start = 0);
    Driveline.Wheels pump(speed = pump_speed);
    Driveline.Wheels turbine(speed = turbine_speed);
    Couplings.TorqueConverter converter;
    output Real pump_torque = -pump.torque;
    output Real turbine_torque = turbine.torque;
    output Real heat = converter.loss_power;
  equation
    connect(pump.flange, converter.a);
    connect(converter.b, turbine.flange);
  end ConverterBench;

  model ColdStopStartOnCycle
    extends PoweredCar(redeclare AdasPowertrain.Powertrains.CombustionDualClutch powertrain(
      initial_speed = initial_speed/radius, is_cold = true, has_stop_start = true));
    extends Driver;
  end ColdStopStartOnCycle;

  model PhasesOnCycle "Shifts with two phases, intervention and a charger"
    extends PoweredCar(redeclare AdasPowertrain.Powertrains.CombustionDualClutch powertrain(
      initial_speed = initial_speed/radius, shift_time = 0.45, torque_phase = 0.15, intervention_share = 1, has_charger = true));
    extends Driver;
  end PhasesOnCycle;

  model SlipControlOnCycle
    extends PoweredCar(redeclare AdasPowertrain.Powertrains.CombustionAutomatic powertrain(initial_speed = initial_speed/radius, has_slip_control = true));
    extends Driver;
  end SlipControlOnCycle;

  model SlipControlBench "Engine torque over time into converter and clutch, a car in third gear behind; begins with the clutch closed"
    AdasPowertrain.Gearboxes.StepAutomatic gearbox(
      data = data,
      has_slip_control = true,
      initial_speed = 52,
      max_power = 110e3,
      wheel_speed = 52/3.5,
      power_demand = 0);
    parameter AdasPowertrain.Vehicles.SixSpeedAutomatic data(final_ratio = 3.5);
    Driveline.Inertia engine(inertia = 0.15, initial_speed = gearbox.initial_input_speed);
    Driveline.TorqueSource source(torque = 100 + 40*sin(2*time));
    Driveline.Inertia car(inertia = 12, initial_speed = 52);
    Driveline.TorqueSource load(torque = -225);
    output Real slip = gearbox.lock_up.slip;
    output Real ratio = gearbox.gear.schedule.ratio;
    output Real pump = gearbox.converter.pump_speed;
    output Integer mode = gearbox.lock_up.mode;
    output Real loss(start = 0, fixed = true);
    output Real work(start = 0, fixed = true);
    output Real energy = engine.energy + car.energy + gearbox.energy;
  protected
    Real angle(start = 0, fixed = true);
  equation
    angle = engine.a.phi;
    connect(source.flange, engine.a);
    connect(engine.b, gearbox.a);
    connect(gearbox.b, car.a);
    connect(car.b, load.flange);
    der(loss) = gearbox.loss_power;
    der(work) = source.torque*engine.speed + load.torque*car.speed;
  end SlipControlBench;

  model Heater "Takes heat"
    AdasPowertrain.Interfaces.HeatPort port;
  equation
    port.Q_flow = 600;
  end Heater;

  model WarmingBench "Constant losses into the body of an engine, a heater that takes some"
    AdasPowertrain.Engines.Warming body(is_modelled = true, losses = 9000);
    Heater heater;
    output Real temperature = body.temperature;
    output Real friction_factor = body.friction_factor;
  equation
    connect(heater.port, body.heat);
  end WarmingBench;

  model StopStartBench "An idling engine that stops for 3 s"
    parameter AdasPowertrain.Vehicles.TurboPetrol15 data;
    AdasPowertrain.Engines.Dynamic engine(
      data = data,
      inertia = 0.15,
      torque_demand = 0,
      has_stop_start = true,
      may_stop = time > 1 and time < 4);
    output Real speed = engine.speed;
    output Real electric = engine.electric_power;
    output Real energy_in(start = 0, fixed = true);
    output Real energy_loss(start = 0, fixed = true);
    output Real energy = engine.energy;
  equation
    der(energy_in) = engine.fuel_power + engine.electric_power;
    der(energy_loss) = engine.loss_power + engine.starter_loss;
  end StopStartBench;
end Combustion;
