within AdasPowertrain.Parts;
model ThermalEngine15 "Four-cylinder petrol engine, 1.5 l, 110 kW, that warms up; its heat port is in a coolant circuit"
  parameter Real ambient(unit = "K", min = 230, max = 330) = 296.15;
  extends Engine15(is_cold = true, body(ambient = ambient));
  Interfaces.RealInput heat_flow(unit = "W", start = 0) "Into the engine's body";
  Interfaces.RealOutput temperature(unit = "K");
  Thermal.GivenHeat coolant(power = heat_flow);
equation
  connect(coolant.heat, body.heat);
  temperature = body.temperature;
end ThermalEngine15;
