within AdasPowertrain.Parts;
model HybridEquivalentControl
  "Energy management of a P2 hybrid by equivalent consumption (ECMS): at each instant the engine's torque minimises fuel
   power + equivalence*battery power, and the engine runs while that saves more than is lost by its start. The
   equivalence follows the state of charge (A. Chasse, A. Sciarretta: Supervisory control of hybrid powertrains, Control
   Engineering Practice 19, 2011; Onori, Serrao, Rizzoni, Hybrid Electric Vehicles, 2016, ch. 6). Same ports as
   HybridControl"
  extends HybridManagement;
  parameter Vehicles.TurboPetrol15 engine_data(auxiliary_power = 0);
  parameter Real engine_scale(min=0.3, max=3) = 1 "Displacement and torque against the engine's data";
  parameter Real equivalence(min=1, max=10) = 2.8 "Fuel power that one watt out of the battery is worth, at the target";
  parameter Real equivalence_gain(min=0, max=100) = 10 "More per state of charge missing";
  parameter Real equivalence_time(unit="s", min=10, max=1e5) = 400 "Time constant at which a lasting deviation moves the equivalence";
  parameter Real start_saving(unit="W", min=0, max=20000) = 1500 "Fuel power that is to be saved for the engine to start";
  parameter Real stop_saving(unit="W", min=-20000, max=20000) = -500 "Fuel power below which it stops";
  parameter Real linear_loss(unit="W/(N.m)", min=0, max=100) = 5.4 "Of machine and inverter";
  parameter Real squared_loss(unit="W/(N2.m2)", min=0, max=2) = 0.047 "Of machine and inverter";
  parameter Real battery_loss(unit="1/W", min=0, max=1e-4) = 2.5e-6 "Loss of the battery per squared power";
  parameter Real low_soc(min=0, max=1) = 0.4 "The engine runs below";
protected
  Real slope "Of the engine's Willans line";
  Real full_load(unit="N.m") "Of the engine";
  Real throttling(unit="N.m") "Of the engine with a closed throttle";
  Real natural(unit="N.m") "Torque of the engine's charge without throttle and boost";
  Real drag(unit="N.m") "Of the engine without fuel";
  Real machine_limit(unit="N.m") "Most that machine and battery give";
  Real lowest(unit="N.m") "The engine gives what machine and battery cannot";
  Real price "Fuel power that one watt out of the battery is worth, now";
  Real saving(unit="W") "Of the running engine";
  Real deviation(start=0, fixed=true) "State of charge that was missing, integrated over equivalence_time";
  Boolean is_needed(start=false, fixed=true) "The machine alone cannot, or the battery is low";
  Boolean is_saving(start=false, fixed=true);
equation
  der(deviation) = (target_soc - soc)/equivalence_time;
  price = noEvent(max(1, equivalence + equivalence_gain*(target_soc - soc + deviation)));
  slope = Tables.smooth1D(machine_speed, engine_data.speeds, engine_data.efficiency);
  full_load = noEvent(max(least_engine_torque, engine_scale*Tables.smooth1D(machine_speed, engine_data.speeds, engine_data.full_load)));
  throttling = engine_scale*engine_data.displacement/12.566*engine_data.throttling_pressure;
  natural = engine_scale*engine_data.displacement/12.566*engine_data.natural_pressure;
  drag = throttling + engine_scale*engine_data.displacement/12.566*(engine_data.friction_pressure + engine_data.friction_pressure_1*abs(machine_speed)
    + engine_data.friction_pressure_2*machine_speed*machine_speed) + engine_scale*engine_data.auxiliary_power/noEvent(max(machine_speed, 50));
  machine_limit = noEvent(min(request.highest, machine_torque_limit));
  lowest = noEvent(min(full_load, max(least_engine_torque, shaft_torque - machine_limit)));
  best = equivalentSplit(shaft_torque, machine_speed, slope, drag, throttling, natural, engine_data.late_ignition, price, linear_loss,
    squared_loss, battery_loss, lowest, noEvent(min(full_load, shaft_torque - max(request.lowest, -machine_torque_limit))));
  saving = price*(equivalentPower(shaft_torque, machine_speed, linear_loss, squared_loss, battery_loss)
    - equivalentPower(shaft_torque - best, machine_speed, linear_loss, squared_loss, battery_loss))
    - Engines.fuelTorque(Engines.chargeTorque(best + drag, throttling, natural), natural, engine_data.late_ignition)*machine_speed/slope;
  is_needed = soc < low_soc or shaft_torque > (if pre(is_needed) then 0.6 else 0.9)*machine_limit;
  is_saving = saving > (if pre(is_saving) then stop_saving else start_saving);
  is_wanted = is_needed or is_saving;
  is_urgent = is_needed;
end HybridEquivalentControl;
