within AdasPowertrain.Batteries;
block PowerLimits "Power that the battery management allows: full within the window of the state of charge, fading out at its ends"
  parameter Real max_discharge_power(unit="W", min=0, max=1e6) = 160000 "At the poles";
  parameter Real max_charge_power(unit="W", min=0, max=1e6) = 100000 "At the poles";
  parameter Real least_soc(min=0, max=1) = 0.05 "Nothing is given below";
  parameter Real greatest_soc(min=0, max=1) = 0.98 "Nothing is taken above";
  parameter Real fading_soc(min=0.001, max=0.5) = 0.05 "Width of state of charge over which the limits fade";
  input Real soc "State of charge";
  output Real discharge_power(unit="W");
  output Real charge_power(unit="W");
equation
  discharge_power = max_discharge_power * noEvent(max(0, min(1, (soc - least_soc) / fading_soc)));
  charge_power = max_charge_power * noEvent(max(0, min(1, (greatest_soc - soc) / fading_soc)));
end PowerLimits;
