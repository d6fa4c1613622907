within AdasPowertrain.Parts;
function equivalentPower "Battery power for a torque of the machine, without what does not depend on the torque"
  input Real machine_torque(unit = "N.m");
  input Real speed(unit = "rad/s");
  input Real linear_loss(unit = "W/(N.m)") "Of the machine";
  input Real squared_loss(unit = "W/(N2.m2)") "Of the machine";
  input Real battery_loss(unit = "1/W") "Loss per squared power";
  output Real power(unit = "W");
protected
  Real electric(unit = "W");
algorithm
  electric := machine_torque*speed + linear_loss*abs(machine_torque) + squared_loss*machine_torque*machine_torque;
  power := electric + battery_loss*electric*electric;
end equivalentPower;
