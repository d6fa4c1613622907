within AdasPowertrain.Engines;
model Charger
  "Turbocharger by its state, the boost pressure: it follows what the wanted torque needs, with a time constant inverse to the
   exhaust's mass flow, since the turbine's power grows with it (L. Guzzella, C. Onder: Introduction to Modeling and Control
   of Internal Combustion Engine Systems, 2010, section 2.6). The torque is limited in proportion to the pressure. Time
   constant: ours, usual for the class"
  parameter Boolean is_modelled = false "Else the pressure stays that of the air";
  parameter Real natural_torque(unit = "N.m", min = 0) "Of the combustion, without boost";
  parameter Real air_pressure(unit = "Pa", min = 5e4, max = 1.1e5) = 1.013e5;
  parameter Real time_constant(unit = "s", min = 0.01, max = 5) = 0.4 "At the reference flow";
  parameter Real reference_flow(unit = "kg/s", min = 1e-3) = 0.05;
  parameter Real least_flow(unit = "kg/s", min = 1e-4) = 0.005 "Less does not slow it further";
  Interfaces.RealInput wanted(unit = "N.m") "Of the combustion";
  Interfaces.RealInput exhaust(unit = "kg/s") "Mass flow";
  Real boost(unit = "Pa", start = air_pressure, fixed = true, nominal = 1e5) "Absolute pressure before the cylinders";
  Real limit(unit = "N.m") "Torque of the combustion that it allows";
equation
  der(boost) = if is_modelled then (air_pressure*noEvent(max(1, wanted/natural_torque)) - boost)
    *noEvent(max(exhaust, least_flow))/(time_constant*reference_flow) else 0;
  limit = natural_torque*boost/air_pressure;
end Charger;
