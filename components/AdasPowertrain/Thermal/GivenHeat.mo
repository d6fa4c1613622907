within AdasPowertrain.Thermal;
model GivenHeat "Heat that is known, into what is connected"
  Interfaces.HeatPort heat;
  Interfaces.RealInput power(unit = "W") "Heats if > 0";
equation
  heat.Q_flow = -power;
end GivenHeat;
