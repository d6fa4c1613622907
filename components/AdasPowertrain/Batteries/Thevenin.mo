within AdasPowertrain.Batteries;
model Thevenin "Battery on a direct-current link: open-circuit voltage, resistance and two resistor-capacitor pairs"
  Interfaces.DcLink link;
  EquivalentCircuit circuit;
  PowerLimits limits;
  parameter Boolean has_cell_limits = false "Of voltage; else the management's limits alone";
  output Real discharge_power(unit="W") "Most it gives now";
  output Real charge_power(unit="W") "Most it takes now";
equation
  circuit.electric_power = -link.p;
  link.v = circuit.voltage;
  limits.soc = circuit.soc;
  discharge_power = if has_cell_limits then noEvent(min(limits.discharge_power, circuit.discharge_power)) else limits.discharge_power;
  charge_power = if has_cell_limits then noEvent(min(limits.charge_power, circuit.charge_power)) else limits.charge_power;
end Thevenin;
