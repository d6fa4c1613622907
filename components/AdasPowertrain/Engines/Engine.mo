within AdasPowertrain.Engines;
partial model Engine
  "What all combustion engines share: friction, full load, fuel by Willans lines. The throttle lowers the intake's pressure in
   proportion to the charge that is missing to the unthrottled one, and the pistons draw against it"
  parameter Vehicles.EngineData data;
  parameter Real scale(min = 0) = 1 "Displacement, torque and what the auxiliaries take, against the data";
  parameter Vehicles.Fuel fuel;
  parameter Boolean is_cold = false "Warms up from initial_temperature; else it is warm";
  parameter Real initial_temperature(unit = "K", min = 230, max = 400) = 296.15 "Of a cold engine";
  Warming body(is_modelled = is_cold, initial_temperature = initial_temperature, heat_capacity = scale*65e3, losses = loss_power);
  parameter Boolean has_charger = false "The torque follows the boost pressure of a turbocharger; else it is there at once";
  Charger charger(is_modelled = has_charger, natural_torque = scale*data.displacement/(4*pi)*data.natural_pressure, wanted = noEvent(min(wanted, full)) - throttling,
    exhaust = fuel_power/fuel.heating_value*(1 + fuel.air_per_fuel));
  input Real intervention(unit = "N.m") = 0 "Torque taken away by late ignition, at once";
  Interfaces.RealInput torque_demand(unit = "N.m", start = 0) "On the crankshaft, beyond what the auxiliaries take; >= 0";
  Real speed(unit = "rad/s") "Of the crankshaft";
  Interfaces.RealOutput torque(unit = "N.m") "On the crankshaft, before its inertia";
  Interfaces.RealOutput fuel_power(unit = "W");
  Interfaces.RealOutput co2(unit = "kg/s");
  Real loss_power(unit = "W") "To exhaust and coolant, by friction and for the auxiliaries";
protected
  constant Real pi = 3.14159265358979;
  constant Real standing(unit = "rad/s") = 5 "Friction falls to zero below";
  constant Real light(unit = "N.m") = 10 "Demands below this lead over to overrun";
  constant Real rounding(unit = "N.m") = 2 "Of limits";
  Real warm_friction(unit = "N.m") "Of the warm engine";
  Real friction(unit = "N.m");
  Real auxiliaries(unit = "N.m");
  Real throttling(unit = "N.m") "With the throttle closed";
  Real drag(unit = "N.m") "All three: of the engine without fuel";
  constant Real least_ignition = 0.3 "Part of the torque that the latest ignition leaves";
  Real full(unit = "N.m") "Torque of the combustion at full load";
  Real highest(unit = "N.m") "The same with the boost there is";
  Real wanted(unit = "N.m") "Torque of the combustion for the demand";
  Real combustion(unit = "N.m") "What the fuel adds to the torque without it, >= 0";
  Real warming(unit = "N.m") "Torque of the charge that warms the cold engine up, beyond its friction";
  Real charge(unit = "N.m") "Torque of the charge: what the fuel adds less what it spares in throttling";
  Real ignited(unit = "N.m") "The same with the intervention";
  Real slope "Of the Willans line";
equation
  warm_friction = scale*data.displacement/(4*pi)*(data.friction_pressure + data.friction_pressure_1*abs(speed)
    + data.friction_pressure_2*speed*speed)*Smooth.direction(speed, standing);
  friction = body.friction_factor*warm_friction;
  auxiliaries = scale*data.auxiliary_power*speed/(speed*speed + 400);
  throttling = scale*data.displacement/(4*pi)*data.throttling_pressure*Smooth.direction(speed, standing);
  drag = friction + auxiliaries + throttling;
  full = max(0, scale*Tables.smooth1D(speed, data.speeds, data.full_load) + drag);
  highest = if has_charger then noEvent(min(full, charger.limit + throttling)) else full;
  wanted = max(0, torque_demand) + drag*Smooth.direction(max(0, torque_demand), light);
  ignited = noEvent(max(least_ignition*combustion, combustion - intervention));
  torque = ignited - drag;
  slope = Tables.smooth1D(speed, data.speeds, data.efficiency);
  charge = chargeTorque(combustion, throttling, charger.natural_torque);
  warming = noEvent(max(0, (body.loss_factor - 1)*(warm_friction + throttling) - (friction - warm_friction))*min(1, combustion/light));
  fuel_power = (fuelTorque(charge, charger.natural_torque, data.late_ignition) + warming)*max(0, speed)/slope;
  co2 = fuel.co2_per_energy*fuel_power;
  loss_power = fuel_power - charge*max(0, speed) + (combustion - ignited)*max(0, speed) + (friction + auxiliaries)*speed
    + (throttling + charge - combustion)*speed;
end Engine;
