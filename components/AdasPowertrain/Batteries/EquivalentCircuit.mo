within AdasPowertrain.Batteries;
block EquivalentCircuit
  "Battery of equal cells: open-circuit voltage over state of charge, resistance and two resistor-capacitor pairs in
   series. Circuit, open-circuit voltage and all six of its values: Chen and Rincon-Mora, IEEE Trans. Energy Convers.
   21 (2006), eq. 2 to 7 at high state of charge, for a cell of 0.85 Ah; resistances are scaled by capacity, so that a
   cell's drop depends on its C-rate alone. With has_low_charge_rise they rise at low state of charge as in eq. 3 to 6;
   capacitances stay those of high state of charge. The table is their eq. 2, rounded to 0.1 mV. Losses are those of the
   resistors; nothing is lost by storing charge."
  parameter Integer series_cells(min=1, max=2000) = 108 "Cells in series";
  parameter Real capacity(unit="C", min=3600, max=3.6e6) = 561600 "Of the whole battery, from full to empty; 3600 C = 1 Ah";
  parameter Real initial_soc(min=0, max=1) = 0.8 "State of charge at the start";
  parameter Real specific_resistance(unit="Ohm.C", min=0) = 227.8 "A cell's series resistance times its capacity";
  parameter Real fast_resistance(unit="Ohm.C", min=1e-3) = 142.9 "Of the fast pair, times capacity";
  parameter Real slow_resistance(unit="Ohm.C", min=1e-3) = 152.5 "Of the slow pair, times capacity";
  parameter Real fast_time(unit="s", min=0.1) = 32.85 "Time constant of the fast pair";
  parameter Real slow_time(unit="s", min=0.1) = 223.0 "Time constant of the slow pair";
  parameter Real soc_axis[13] = {0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1} "State of charge of the points";
  parameter Real cell_voltage[13](each unit="V") = {2.6540, 3.1773, 3.5164, 3.6746, 3.7250, 3.7477, 3.7729, 3.8034, 3.8411, 3.8880, 3.9460, 4.0170, 4.1029}
    "Open-circuit voltage of a cell there";
  parameter Real least_cell_voltage(unit="V", min=1) = 2.8;
  parameter Real highest_cell_voltage(unit="V", min=1) = 4.2;
  parameter Boolean has_low_charge_rise = false "Resistances rise at low state of charge";
  input Real resistance_factor = 1 "On all resistances, by temperature";
  input Real electric_power(unit="W") "Given at the poles";
  output Real voltage(unit="V") "At the poles";
  output Real soc(start=0.8) "State of charge";
  output Real battery_power(unit="W") "Drawn from the cells: open-circuit voltage times current";
  output Real loss(unit="W");
  output Real stored_energy(unit="J") "In the capacitors";
  output Real discharge_power(unit="W") "Most it gives at the poles within the cells' voltages, with the capacitors charged";
  output Real charge_power(unit="W") "Most it takes, likewise";
  Real current(unit="A") "Out of the battery";
  Real open_circuit_voltage(unit="V");
protected
  parameter Real first_capacitance(unit="F") = fast_time * capacity / (fast_resistance * series_cells);
  parameter Real second_capacitance(unit="F") = slow_time * capacity / (slow_resistance * series_cells);
  Real unit_resistance(unit="1/C") "Resistance per specific resistance, at high state of charge";
  Real resistance(unit="Ohm");
  Real first_resistance(unit="Ohm");
  Real second_resistance(unit="Ohm");
  Real charge(unit="C", start=initial_soc * capacity, fixed=true, nominal=1e5);
  Real fast_voltage(unit="V", start=0, fixed=true);
  Real slow_voltage(unit="V", start=0, fixed=true);
  Real inner_voltage(unit="V") "Behind the series resistance";
  Real discriminant(unit="V2");
equation
  soc = charge / capacity;
  der(charge) = -current;
  open_circuit_voltage = series_cells * Tables.smooth1D(soc, soc_axis, cell_voltage, Tables.Extrapolation.linear);
  inner_voltage = open_circuit_voltage - fast_voltage - slow_voltage;
  /* power = (inner_voltage - resistance current) current; of its two roots the one that vanishes with the power. */
  discriminant = inner_voltage ^ 2 - 4 * resistance * electric_power;
  assert(discriminant > 0, "more power is asked than the battery can give");
  current = 2 * electric_power / (inner_voltage + sqrt(noEvent(max(discriminant, 0))));
  voltage = inner_voltage - resistance * current;
  unit_resistance = resistance_factor * series_cells / capacity;
  resistance = specific_resistance * unit_resistance * (if has_low_charge_rise then 1 + 2.0978 * exp(-24.37 * soc) else 1);
  first_resistance = fast_resistance * unit_resistance * (if has_low_charge_rise then 1 + 6.8709 * exp(-29.14 * soc) else 1);
  second_resistance = slow_resistance * unit_resistance * (if has_low_charge_rise then 1 + 132.48 * exp(-155.2 * soc) else 1);
  discharge_power = noEvent(max(0, series_cells * least_cell_voltage * (open_circuit_voltage - series_cells * least_cell_voltage)
    / (resistance + first_resistance + second_resistance)));
  charge_power = noEvent(max(0, series_cells * highest_cell_voltage * (series_cells * highest_cell_voltage - open_circuit_voltage)
    / (resistance + first_resistance + second_resistance)));
  first_capacitance * der(fast_voltage) = current - fast_voltage / first_resistance;
  second_capacitance * der(slow_voltage) = current - slow_voltage / second_resistance;
  battery_power = open_circuit_voltage * current;
  loss = resistance * current ^ 2 + fast_voltage ^ 2 / first_resistance + slow_voltage ^ 2 / second_resistance;
  stored_energy = 0.5 * (first_capacitance * fast_voltage ^ 2 + second_capacitance * slow_voltage ^ 2);
end EquivalentCircuit;
