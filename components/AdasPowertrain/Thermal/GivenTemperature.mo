within AdasPowertrain.Thermal;
model GivenTemperature "A body whose temperature is known; the heat into it is found"
  Interfaces.HeatPort heat;
  Interfaces.RealInput temperature(unit = "K");
  Interfaces.RealOutput power(unit = "W") "Into the body";
equation
  heat.T = temperature;
  power = heat.Q_flow;
end GivenTemperature;
