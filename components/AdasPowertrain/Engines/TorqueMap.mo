within AdasPowertrain.Engines;
model TorqueMap "Quasi-static engine without inertia: gives at once what the map allows; never below idle torque"
  extends Engine;
equation
  combustion = max(0, Smooth.minimum(highest, wanted, rounding));
end TorqueMap;
