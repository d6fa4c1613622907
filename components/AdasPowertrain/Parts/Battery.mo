within AdasPowertrain.Parts;
model Battery
  "Traction battery with its circuit and energy balance. Defaults: BMW i3 (94 Ah): 96 cells in series of 94 Ah, 33 kWh
   (technical data, 2016); circuit of Batteries.EquivalentCircuit."
  parameter Integer series_cells(min=20, max=220) = 96 "Cells in series";
  parameter Real capacity(unit="C", min=3600, max=2e6) = 338400 "From full to empty; 3600 C = 1 Ah";
  parameter Real resistance_share(min=0.01, max=5) = 1 "Resistances over those of energy cells; power cells of hybrids about 0.1 to 0.3";
  parameter Real initial_soc(min=0, max=1) = 0.5 "State of charge at the start";
  parameter Real auxiliary_power(unit="W", min=0, max=10000) = 350 "Taken for light, cooling and control units";
  Interfaces.RealInput electric_power(unit="W", start=0) "Given to the machine's cables";
  Interfaces.RealInput charging_power(unit="W", start=0) "Fed by a generator";
  Interfaces.RealOutput voltage(unit="V") "At the poles";
  Interfaces.RealOutput soc "State of charge";
  Interfaces.RealOutput battery_power(unit="W") "Drawn from the cells, negative when charging";
  Interfaces.RealOutput discharge_power(unit="W") "Most it gives to the machine's cables now";
  Interfaces.RealOutput charge_power(unit="W") "Most it takes from them now";
  Interfaces.RealOutput energy_in(unit="J", start=0, fixed=true) "Out of the cells, since the start";
  Interfaces.RealOutput energy_out(unit="J", start=0, fixed=true) "To the cables, since the start";
  Interfaces.RealOutput energy_loss(unit="J", start=0, fixed=true) "Turned into heat or used on board, since the start";
  Interfaces.RealOutput energy_stored(unit="J") "In the capacitors, now";
  Batteries.EquivalentCircuit circuit(series_cells=series_cells, capacity=capacity, initial_soc=initial_soc,
    specific_resistance=227.8 * resistance_share, fast_resistance=142.9 * resistance_share, slow_resistance=152.5 * resistance_share);
equation
  circuit.electric_power = electric_power - charging_power + auxiliary_power;
  voltage = circuit.voltage;
  soc = circuit.soc;
  battery_power = circuit.battery_power;
  discharge_power = noEvent(max(0, circuit.discharge_power - auxiliary_power + charging_power));
  charge_power = noEvent(max(0, circuit.charge_power + auxiliary_power - charging_power));
  der(energy_in) = battery_power;
  der(energy_out) = electric_power - charging_power;
  der(energy_loss) = circuit.loss + auxiliary_power;
  energy_stored = circuit.stored_energy;
end Battery;
