within AdasPowertrain.Parts;
model ThermalBattery
  "Battery of lithium iron phosphate cells with one temperature and ageing. Resistances follow Arrhenius' law and rise at low
   state of charge. Heat capacity: A123 ANR26650, 76 g for 2.5 Ah, at 1 kJ/(kg.K). Open-circuit voltage: that of the
   electrodes (positive: Afshar, Morris, Khajepour, arXiv 1709.03970, 2017; negative: Chen et al., J. Electrochem. Soc. 167,
   2020, 080534), at lithium contents of 0.02 to 0.8 (negative) and 0.8 to 0.02 (positive). Activation energy: ours, the
   resistance doubles from 25 to 1 degree Celsius. Losses include no heat of reaction"
  parameter Real activation_energy(unit="J/mol", min=0, max=1e5) = 20e3 "Of the resistances";
  parameter Real specific_heat(unit="J/(K.C)", min=1e-4) = 8.44e-3 "Of a cell, per charge";
  parameter Real conductance(unit="W/K", min=0) = 4 "To the air";
  parameter Real ambient(unit="K", min=230, max=330) = 296.15;
  parameter Real initial_temperature(unit="K", min=230, max=350) = 296.15;
  parameter Real throughput_factor(min=0) = 1 "Charge through the battery counts so many times for its ageing";
  parameter Real time_factor(min=0) = 1 "Time counts so many times for the ageing";
  parameter Real initial_cycle_loss(min=0, max=0.5) = 0 "Part of the new capacity that cycles took before";
  parameter Real initial_calendar_loss(min=0, max=0.5) = 0 "Part of the new capacity that time took before";
  extends Battery(circuit(
    capacity=capacity * (1 - initial_cycle_loss - initial_calendar_loss),
    has_low_charge_rise=true,
    least_cell_voltage=2.0,
    highest_cell_voltage=3.6,
    resistance_factor=exp(activation_energy / 8.314 * (1 / body.temperature - 1 / 298.15)),
    cell_voltage={2.0845, 2.4996, 2.7971, 2.9798, 3.1668, 3.2035, 3.2503, 3.2647, 3.2678, 3.2721, 3.3074, 3.3136, 3.3402}));
  Interfaces.RealInput heat_flow(unit="W", start=0) "Into the battery";
  Interfaces.RealOutput temperature(unit="K");
  Interfaces.RealOutput state_of_health "Capacity over that of the new battery";
  Thermal.Body body(heat_capacity=specific_heat * series_cells * capacity, conductance=conductance, ambient=ambient,
    initial_temperature=initial_temperature, losses=circuit.loss);
  Thermal.GivenHeat coolant(power=heat_flow);
  Batteries.Ageing ageing(capacity=capacity, throughput_factor=throughput_factor, time_factor=time_factor,
    initial_cycle_loss=initial_cycle_loss, initial_calendar_loss=initial_calendar_loss,
    temperature=body.temperature, current=circuit.current, soc=circuit.soc);
equation
  connect(coolant.heat, body.heat);
  temperature = body.temperature;
  state_of_health = ageing.state_of_health;
end ThermalBattery;
