within AdasPowertrain.Powertrains;
model CombustionLimitedSlip "Petrol engine, dual-clutch gearbox and limited-slip differential, torque by wheel"
  parameter Real preload(unit = "N.m", min = 1, max = 1000) = 80 "Moved from wheel to wheel without any torque on the carrier; > 0";
  parameter Real locking(min = 0, max = 1) = 0.35 "Torque that can be moved from wheel to wheel against that on the carrier";
  extends CombustionDualClutchByWheel(
    redeclare Driveline.LimitedSlipDifferential differential(
      ratio = final_ratio, initial_speed = initial_speed, preload = preload, locking = locking));
end CombustionLimitedSlip;
