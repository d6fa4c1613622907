within AdasPowertrain.Machines;
block Controlled
  "Synchronous machine with inverter and torque control: torque after a lag within its envelope, losses computed where
   they arise. Torque control settles like a first-order lag; the envelope is constant torque, then constant power,
   and not more power than the voltage allows. The voltage is measured with a lag, so that the power taken never
   depends on it at once. The rotor's inertia belongs to what the shaft is joined to."
  parameter Real max_torque(unit="N.m", min=1, max=1000) = 310 "Largest torque either way";
  parameter Real max_power(unit="W", min=1000, max=500000) = 150000 "Largest power of the shaft either way";
  parameter Real torque_lag(unit="s", min=0.001, max=1) = 0.02 "Time constant of the torque";
  parameter Integer pole_pairs(min=1, max=20) = 4 "Pairs of poles";
  parameter Real flux_linkage(unit="Wb", min=0.001, max=1) = 0.0812 "Of the magnets in a phase, amplitude; reluctance torque counted in";
  parameter Real inductance(unit="H", min=1e-6, max=0.1) = 1.22e-4 "Of a phase";
  parameter Real stator_resistance(unit="Ohm", min=0, max=1) = 0.007 "Of a phase, warm";
  parameter Real hysteresis_loss(min=0) = 35 "Iron loss per flux squared and electrical speed, W.s/(Wb2.rad)";
  parameter Real eddy_loss(min=0) = 0.012 "Iron loss per flux squared and electrical speed squared, W.s2/(Wb2.rad2)";
  parameter Real viscous_friction(unit="N.m.s/rad", min=0) = 2e-4 "Of bearings and air";
  parameter Real modulation(min=0.1, max=1.1) = 0.95 "Largest phase voltage over its limit, link voltage / sqrt(3)";
  parameter Real voltage_lag(unit="s", min=0.001, max=1) = 0.05 "Of the link voltage as the field weakening sees it";
  parameter Real initial_voltage(unit="V", min=1, max=1500) = 400 "Link voltage as it is seen at the start";
  input Real torque_demand(unit="N.m", start=0) "At the shaft";
  input Real shaft_speed(unit="rad/s", start=0);
  input Real voltage(unit="V", start=initial_voltage) "Of the direct-current link";
  input Real copper_factor = 1 "On the copper losses, by temperature";
  input Real derating = 1 "On the torque limit, by temperature";
  output Real torque(unit="N.m", start=0, fixed=true) "On the shaft";
  output Real torque_limit(unit="N.m") "Most it gives now, either way";
  output Real electric_power(unit="W") "Taken from the link";
  output Real loss(unit="W") "Of machine and inverter";
  SteadyState machine(pole_pairs=pole_pairs, flux_linkage=flux_linkage, inductance=inductance, stator_resistance=stator_resistance,
    hysteresis_loss=hysteresis_loss, eddy_loss=eddy_loss, viscous_friction=viscous_friction, modulation=modulation);
  replaceable Inverters.Averaged inverter;
protected
  Real seen_voltage(unit="V", start=initial_voltage, fixed=true);
  Real power_limit(unit="W");
  Real target(unit="N.m");
  Boolean is_fast(start=false) "Above the corner of the envelope";
equation
  der(seen_voltage) = (voltage - seen_voltage) / voltage_lag;
  machine.torque = torque;
  machine.speed = shaft_speed;
  machine.link_voltage = seen_voltage;
  inverter.current_squared = machine.current_squared;
  inverter.link_voltage = seen_voltage;
  power_limit = noEvent(min(max_power, 0.95 * machine.available_power));
  is_fast = max_torque * abs(shaft_speed) > power_limit;
  torque_limit = derating * (if is_fast then power_limit / abs(shaft_speed) else max_torque);
  target = if torque_demand > torque_limit then torque_limit elseif torque_demand < -torque_limit then -torque_limit else torque_demand;
  der(torque) = (target - torque) / torque_lag;
  loss = copper_factor * machine.copper_loss + machine.iron_loss + machine.friction_loss + inverter.loss;
  electric_power = torque * shaft_speed + loss;
end Controlled;
