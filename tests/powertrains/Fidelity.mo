package Fidelity "Benches of shifts with two phases, charger, temperatures and ageing"
  import AdasPowertrain.Driveline;
  import AdasPowertrain.Thermal;

  model ShiftBench "Constant torque into a gearbox whose output keeps its speed; what the schedule sees jumps at 1 s"
    parameter Real torque = 100;
    parameter Real output_speed = 80;
    parameter Real seen = 90 "By the schedule, after 1 s";
    parameter Real intervention_share = 0;
    parameter Real engine_inertia = 0.15;
    parameter AdasPowertrain.Vehicles.SevenSpeedDualClutch data(final_ratio = 4.438, shift_time = 0.45, torque_phase = 0.15, efficiency = 1, drag = 0);
    Real intervention = intervention_share*(engine_inertia + data.inertia_in)*noEvent(max(0, -gear.schedule.ratio_rate*gear.output_speed));
    Driveline.TorqueSource source(torque = torque - intervention);
    Driveline.Inertia engine(inertia = engine_inertia, initial_speed = output_speed*data.ratios[gear.schedule.initial_gear]);
    AdasPowertrain.Gearboxes.SteppedGear gear(
      data = data,
      initial_speed = output_speed,
      max_power = 1e5,
      wheel_speed = (if time < 1 then output_speed else seen)/data.final_ratio,
      power_demand = 0);
    Driveline.Inertia car(inertia = 1e8, initial_speed = output_speed);
    output Real speed = engine.speed;
    output Real output_torque;
    output Real heat(start = 0, fixed = true);
    output Real work(start = 0, fixed = true);
    output Real kinetic = engine.energy + gear.energy;
    output Real given(start = 0, fixed = true);
  protected
    Real angle(start = 0, fixed = true);
  equation
    angle = engine.a.phi;
    connect(source.flange, engine.a);
    connect(engine.b, gear.a);
    connect(gear.b, car.a);
    output_torque = car.a.tau;
    der(heat) = gear.loss_power;
    der(work) = source.torque*engine.speed;
    der(given) = output_torque*car.speed;
  end ShiftBench;

  model TurboBench "An engine at constant speed, from little load to full load after 1 s; its intervention is constant"
    parameter Real turning = 157;
    parameter Real asked = 0 "Of the ignition";
    AdasPowertrain.Parts.Engine15 engine(
      has_charger = true,
      on = true,
      petrol(air_lag = 0.06),
      intervention = asked,
      shaft_speed = turning,
      torque_demand = if time < 1 then 20 else 400);
    output Real boost = engine.charger.boost;
    output Real torque = engine.torque;
    output Real burned(start = 0, fixed = true);
    output Real lost(start = 0, fixed = true);
    output Real work(start = 0, fixed = true);
  equation
    der(burned) = engine.fuel_power;
    der(lost) = engine.loss_power;
    der(work) = engine.torque*engine.speed;
  end TurboBench;

  model AgeingBench "Constant current, temperature and state of charge"
    parameter Real c_rate = 2;
    parameter Real kelvin = 298.15;
    parameter Real charge = 0.5;
    AdasPowertrain.Batteries.Ageing ageing(
      capacity = 18000,
      throughput_factor = 1000,
      time_factor = 87600,
      initial_cycle_loss = 0.01,
      initial_calendar_loss = 0.02,
      temperature = if time < 1800 then kelvin else kelvin + 15,
      current = 5*c_rate,
      soc = charge);
    output Real cycle_loss = ageing.cycle_loss;
    output Real calendar_loss = ageing.calendar_loss;
    output Real state_of_health = ageing.state_of_health;
  end AgeingBench;

  model CircuitBench "Three bodies on one coolant circuit"
    Thermal.CoolantCircuit circuit(engine_conductance = 30, initial_temperature = 263.15, ambient = 263.15);
    Thermal.Body engine(heat_capacity = 65e3, conductance = 15, ambient = 263.15, initial_temperature = 263.15, losses = 8000);
    Thermal.Body machine(heat_capacity = 20e3, conductance = 5, ambient = 263.15, initial_temperature = 263.15, losses = 900);
    Thermal.Body battery(heat_capacity = 15e3, conductance = 4, ambient = 263.15, initial_temperature = 263.15, losses = 300);
    output Real radiated(start = 0, fixed = true);
    output Real by_air(start = 0, fixed = true);
  equation
    connect(circuit.engine, engine.heat);
    connect(circuit.machine, machine.heat);
    connect(circuit.battery, battery.heat);
    der(radiated) = circuit.radiated;
    der(by_air) = 15*(engine.temperature - 263.15) + 5*(machine.temperature - 263.15) + 4*(battery.temperature - 263.15);
  end CircuitBench;
end Fidelity;
