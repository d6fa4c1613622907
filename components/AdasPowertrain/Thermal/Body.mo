within AdasPowertrain.Thermal;
model Body "Heat capacity of one temperature, cooled by the air and through its port"
  parameter Real heat_capacity(unit = "J/K", min = 1);
  parameter Real conductance(unit = "W/K", min = 0) = 0 "To the air";
  parameter Real ambient(unit = "K", min = 230, max = 330) = 296.15;
  parameter Real initial_temperature(unit = "K", min = 230, max = 450) = 296.15;
  Interfaces.HeatPort heat;
  Interfaces.RealInput losses(unit = "W") "Turned into heat in the body";
  Real temperature(unit = "K", start = initial_temperature, fixed = true, nominal = 300);
equation
  heat.T = temperature;
  heat_capacity*der(temperature) = losses + heat.Q_flow - conductance*(temperature - ambient);
end Body;
