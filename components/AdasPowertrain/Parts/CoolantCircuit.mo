within AdasPowertrain.Parts;
model CoolantCircuit "Coolant circuit by signals: temperatures of the bodies in, heat into them out"
  Thermal.CoolantCircuit circuit;
  Interfaces.RealInput engine_temperature(unit = "K", start = 296.15);
  Interfaces.RealInput machine_temperature(unit = "K", start = 296.15);
  Interfaces.RealInput battery_temperature(unit = "K", start = 296.15);
  Interfaces.RealOutput engine_heat(unit = "W");
  Interfaces.RealOutput machine_heat(unit = "W");
  Interfaces.RealOutput battery_heat(unit = "W");
  Interfaces.RealOutput temperature(unit = "K");
  Thermal.GivenTemperature engine_body(temperature = engine_temperature, power = engine_heat);
  Thermal.GivenTemperature machine_body(temperature = machine_temperature, power = machine_heat);
  Thermal.GivenTemperature battery_body(temperature = battery_temperature, power = battery_heat);
equation
  connect(engine_body.heat, circuit.engine);
  connect(machine_body.heat, circuit.machine);
  connect(battery_body.heat, circuit.battery);
  temperature = circuit.temperature;
end CoolantCircuit;
