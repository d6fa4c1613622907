within AdasPowertrain.Engines;
function fuelTorque "Torque of the charge with what late ignition against knocking takes; over the slope of the Willans line it is the fuel"
  input Real charge(unit = "N.m");
  input Real natural(unit = "N.m") "Torque of the charge without throttle and boost";
  input Real late_ignition "Additional fuel for the squared part of the charge beyond natural";
  output Real torque(unit = "N.m");
algorithm
  torque := charge + late_ignition*natural*max(0, charge/natural - 1)*max(0, charge/natural - 1);
end fuelTorque;
