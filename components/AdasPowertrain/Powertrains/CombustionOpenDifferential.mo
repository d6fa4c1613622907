within AdasPowertrain.Powertrains;
model CombustionOpenDifferential "Petrol engine, dual-clutch gearbox and open differential, torque by wheel"
  extends CombustionDualClutchByWheel;
end CombustionOpenDifferential;
