within AdasPowertrain.Thermal;
model CoolantCircuit
  "Coolant of one temperature between the heat ports of engine, machine and battery, with a radiator behind a thermostat. A
   valve opens the engine's heat exchanger only while the coolant is cold, so that the engine warms the others. Values:
   ours, usual for a hybrid of the compact class"
  parameter Real heat_capacity(unit = "J/K", min = 100) = 15e3 "5 l of coolant with hoses and plates";
  parameter Real initial_temperature(unit = "K", min = 230, max = 400) = 296.15;
  parameter Real ambient(unit = "K", min = 230, max = 330) = 296.15;
  parameter Real engine_conductance(unit = "W/K", min = 0) = 0 "Of the engine's heat exchanger; 0: the engine has a circuit of its own";
  parameter Real machine_conductance(unit = "W/K", min = 0) = 150;
  parameter Real battery_conductance(unit = "W/K", min = 0) = 80;
  parameter Real radiator(unit = "W/K", min = 0) = 250 "To the air, with the thermostat open";
  parameter Real opening_temperature(unit = "K", min = 250, max = 380) = 298.15 "Of thermostat and valve; 5 K more: open and shut";
  Interfaces.HeatPort engine;
  Interfaces.HeatPort machine;
  Interfaces.HeatPort battery;
  Real temperature(unit = "K", start = initial_temperature, fixed = true, nominal = 300);
  Real radiated(unit = "W") "To the air";
protected
  Real opening "Of the thermostat, 0 to 1";
equation
  opening = noEvent(max(0, min(1, (temperature - opening_temperature)/5)));
  engine.Q_flow = engine_conductance*(1 - opening)*(engine.T - temperature);
  machine.Q_flow = machine_conductance*(machine.T - temperature);
  battery.Q_flow = battery_conductance*(battery.T - temperature);
  radiated = radiator*opening*(temperature - ambient);
  heat_capacity*der(temperature) = engine.Q_flow + machine.Q_flow + battery.Q_flow - radiated;
end CoolantCircuit;
