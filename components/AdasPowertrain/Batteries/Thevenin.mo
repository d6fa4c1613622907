within AdasPowertrain.Batteries;
model Thevenin "Battery on a direct-current link: open-circuit voltage, resistance and two resistor-capacitor pairs"
  Interfaces.DcLink link;
  EquivalentCircuit circuit;
  PowerLimits limits;
equation
  circuit.electric_power = -link.p;
  link.v = circuit.voltage;
  limits.soc = circuit.soc;
end Thevenin;
