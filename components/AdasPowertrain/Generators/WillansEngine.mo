within AdasPowertrain.Generators;
block WillansEngine
  "Small petrol engine: indicated torque after a lag, friction, fuel in proportion to the indicated work. Willans
   lines: Guzzella and Onder, Introduction to Modeling and Control of Internal Combustion Engine Systems, 2010, ch.
   2.5. CO2 per fuel energy of petrol: 73.4 g/MJ (JEC Tank-to-Wheels report v5, 2020)."
  parameter Real max_torque(unit="N.m", min=1, max=1000) = 55 "On the shaft";
  parameter Real indicated_efficiency(min=0.1, max=0.6) = 0.38 "Indicated work over fuel energy";
  parameter Real friction_torque(unit="N.m", min=0) = 5 "At low speed";
  parameter Real friction_rise(unit="N.m.s2/rad2", min=0) = 1e-5 "Friction torque per speed squared";
  parameter Real torque_lag(unit="s", min=0.001, max=5) = 0.15 "Of the intake";
  parameter Real carbon_dioxide(unit="kg/J", min=0) = 7.34e-8 "Per fuel energy";
  input Real torque_demand(unit="N.m") "Wanted on the shaft, at least 0";
  input Boolean is_firing "Fuel is given";
  input Real speed(unit="rad/s");
  output Real torque(unit="N.m") "On the shaft";
  output Real fuel_power(unit="W") "Lower heating value";
  output Real co2(unit="kg/s");
  output Real loss(unit="W");
protected
  Real indicated_torque(unit="N.m", start=0, fixed=true);
  Real friction(unit="N.m");
  Real target(unit="N.m");
equation
  friction = (friction_torque + friction_rise * speed ^ 2) * Smooth.direction(speed, 5);
  target = if not is_firing then 0 elseif torque_demand > max_torque then max_torque + friction else torque_demand + friction;
  der(indicated_torque) = (target - indicated_torque) / torque_lag;
  torque = indicated_torque - friction;
  fuel_power = indicated_torque * speed / indicated_efficiency;
  co2 = carbon_dioxide * fuel_power;
  loss = (1 - indicated_efficiency) * fuel_power + friction * speed;
end WillansEngine;
