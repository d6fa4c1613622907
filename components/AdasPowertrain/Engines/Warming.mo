within AdasPowertrain.Engines;
model Warming
  "One body of oil, coolant and metal, and what its temperature does to the friction: with the oil's viscosity to the power
   of 1/4 (D. Sandoval, J. B. Heywood: An improved friction model for spark-ignition engines, SAE 2003-01-0725, has powers
   of viscosity ratios). Viscosity: Vogel's curve through 45 mm2/s at 40 and 8.5 mm2/s at 100 degrees Celsius, an oil SAE
   0W-20. A cold engine also burns more by enrichment, late ignition that heats the catalyst, and heat into its walls: with
   all of them, its losses without load grow with the temperature to the power of -4 (between 3.5 and 4.5: JRC, CO2MPAS, its
   parameters of charged petrol engines). Heat capacity and conductances: ours, usual for the class"
  parameter Boolean is_modelled = false "Else the body is warm and stays so";
  parameter Real initial_temperature(unit = "K", min = 230, max = 400) = 296.15;
  parameter Real ambient(unit = "K", min = 230, max = 330) = 296.15;
  parameter Real heat_capacity(unit = "J/K", min = 1e3) = 65e3;
  parameter Real share(min = 0, max = 1) = 0.4 "Of the engine's losses into the body; the rest leaves with the exhaust";
  parameter Real conductance(unit = "W/K", min = 0) = 15 "To the air";
  parameter Real radiator(unit = "W/K", min = 0) = 1500 "To the air, with the thermostat open";
  constant Real warm(unit = "K") = 363.15 "The thermostat opens; friction is that of the engine's data";
  Interfaces.HeatPort heat "Of the body, for a heater of the cabin";
  Interfaces.RealInput losses(unit = "W") "Of the engine";
  Real temperature(unit = "K", start = if is_modelled then initial_temperature else warm, fixed = true, nominal = 300);
  Real friction_factor "Friction against that of the warm engine";
  Real loss_factor "Losses without load against those of the warm engine";
protected
  constant Real vogel(unit = "K") = 731;
  constant Real offset(unit = "K") = 178.15 "273.15 - 95";
equation
  heat.T = temperature;
  heat_capacity*der(temperature) = if is_modelled then share*losses + heat.Q_flow - conductance*(temperature - ambient)
    - radiator*noEvent(max(0, min(1, (temperature - warm)/5)))*(temperature - ambient) else 0;
  loss_factor = if is_modelled then noEvent(max(1, (warm/temperature)^4)) else 1;
  friction_factor = if is_modelled then noEvent(max(1, exp(0.25*vogel*(1/(temperature - offset) - 1/(warm - offset))))) else 1;
end Warming;
