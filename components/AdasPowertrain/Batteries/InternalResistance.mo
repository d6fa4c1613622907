within AdasPowertrain.Batteries;
block InternalResistance
  "Battery of equal cells: open-circuit voltage over state of charge and one resistance. Chen and Rincon-Mora, IEEE
   Trans. Energy Convers. 21 (2006), as in EquivalentCircuit, with the capacitors charged: the three resistances in
   series."
  parameter Integer series_cells(min=1, max=2000) = 108 "Cells in series";
  parameter Real capacity(unit="C", min=3600, max=3.6e6) = 561600 "Of the whole battery, from full to empty; 3600 C = 1 Ah";
  parameter Real initial_soc(min=0, max=1) = 0.8 "State of charge at the start";
  parameter Real specific_resistance(unit="Ohm.C", min=0) = 523.2 "A cell's resistance times its capacity";
  parameter Real soc_axis[13] = {0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1} "State of charge of the points";
  parameter Real cell_voltage[13](each unit="V") = {2.6540, 3.1773, 3.5164, 3.6746, 3.7250, 3.7477, 3.7729, 3.8034, 3.8411, 3.8880, 3.9460, 4.0170, 4.1029}
    "Open-circuit voltage of a cell there";
  input Real electric_power(unit="W") "Given at the poles";
  output Real voltage(unit="V") "At the poles";
  output Real soc(start=0.8) "State of charge";
  output Real battery_power(unit="W") "Drawn from the cells: open-circuit voltage times current";
  output Real loss(unit="W");
  Real current(unit="A") "Out of the battery";
  Real open_circuit_voltage(unit="V");
protected
  parameter Real resistance(unit="Ohm") = specific_resistance * series_cells / capacity;
  Real charge(unit="C", start=initial_soc * capacity, fixed=true, nominal=1e5);
  Real discriminant(unit="V2");
equation
  soc = charge / capacity;
  der(charge) = -current;
  open_circuit_voltage = series_cells * Tables.smooth1D(soc, soc_axis, cell_voltage, Tables.Extrapolation.linear);
  /* power = (open_circuit_voltage - resistance current) current; of its two roots the one that vanishes with the power. */
  discriminant = open_circuit_voltage ^ 2 - 4 * resistance * electric_power;
  assert(discriminant > 0, "more power is asked than the battery can give");
  current = 2 * electric_power / (open_circuit_voltage + sqrt(noEvent(max(discriminant, 0))));
  voltage = open_circuit_voltage - resistance * current;
  battery_power = open_circuit_voltage * current;
  loss = resistance * current ^ 2;
end InternalResistance;
