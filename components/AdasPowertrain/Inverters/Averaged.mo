within AdasPowertrain.Inverters;
block Averaged
  "Losses of a three-phase inverter, averaged over the switching and the electrical period. A leg's current flows
   through a transistor or a diode all the time: the mean of |i| is 2/pi of the amplitude, of i2 one half. Switching
   energies scale with current and voltage. (Mohan, Undeland, Robbins: Power Electronics, 2003, ch. 8, 25.) Defaults
   are those of a 750 V IGBT module of traction inverters, rounded."
  parameter Real threshold_voltage(unit="V", min=0) = 0.8 "Of a transistor or diode that conducts";
  parameter Real on_resistance(unit="Ohm", min=0) = 1.2e-3 "Of a transistor or diode that conducts";
  parameter Real switching_time(unit="s", min=0) = 2.5e-7 "Energy of turning on and off and of recovery, per current and link voltage";
  parameter Real switching_frequency(unit="Hz", min=0) = 10000;
  parameter Real standby_loss(unit="W", min=0) = 60 "Of control and gate drivers";
  input Real current_squared(unit="A2") "Amplitude of a phase current, squared";
  input Real link_voltage(unit="V");
  output Real loss(unit="W");
protected
  Real amplitude(unit="A");
equation
  amplitude = current_squared / sqrt(current_squared + 1) "Smooth at zero";
  loss = standby_loss + 6 / 3.14159265358979 * amplitude * (threshold_voltage + switching_frequency * switching_time * link_voltage)
    + 1.5 * on_resistance * current_squared;
end Averaged;
