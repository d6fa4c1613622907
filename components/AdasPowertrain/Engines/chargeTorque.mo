within AdasPowertrain.Engines;
function chargeTorque "Torque of the charge: throttling falls in proportion to it and is nil from the unthrottled charge on"
  input Real combustion(unit = "N.m") "What the fuel adds to the torque without it";
  input Real throttling(unit = "N.m") "With the throttle closed";
  input Real natural(unit = "N.m") "Torque of the charge without throttle and boost";
  output Real charge(unit = "N.m");
algorithm
  charge := max(combustion*natural/(natural + throttling), combustion - throttling);
end chargeTorque;
