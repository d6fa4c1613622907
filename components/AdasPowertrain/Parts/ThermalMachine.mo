within AdasPowertrain.Parts;
model ThermalMachine
  "Machine of 85 kW with one temperature: copper losses rise by 0.393 % per kelvin, and the torque limit fades out as the
   windings get too hot. Heat capacity: 45 kg of steel and copper at 450 J/(kg.K)"
  parameter Real heat_capacity(unit="J/K", min=100) = 20e3;
  parameter Real conductance(unit="W/K", min=0) = 5 "To the air";
  parameter Real ambient(unit="K", min=230, max=330) = 296.15;
  parameter Real initial_temperature(unit="K", min=230, max=450) = 296.15;
  parameter Real derating_temperature(unit="K", min=300, max=500) = 423.15 "The torque limit falls from here …";
  parameter Real highest_temperature(unit="K", min=300, max=500) = 443.15 "… to zero here";
  extends Machine(
    copper_factor=(1 + 0.00393 * (body.temperature - 293.15)) / (1 + 0.00393 * (warm - 293.15)),
    derating=noEvent(max(0, min(1, (highest_temperature - body.temperature) / (highest_temperature - derating_temperature)))));
  constant Real warm(unit="K") = 373.15 "At which the stator has its resistance";
  Interfaces.RealInput heat_flow(unit="W", start=0) "Into the machine";
  Interfaces.RealOutput temperature(unit="K");
  Thermal.Body body(heat_capacity=heat_capacity, conductance=conductance, ambient=ambient, initial_temperature=initial_temperature, losses=loss);
  Thermal.GivenHeat coolant(power=heat_flow);
equation
  connect(coolant.heat, body.heat);
  temperature = body.temperature;
end ThermalMachine;
