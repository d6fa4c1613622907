within AdasPowertrain.Machines;
block EfficiencyMap
  "Synchronous machine with inverter, quasi-static: envelope of torque and power, and a map of losses. The map's
   values are those of Controlled at 396 V, rounded to 1 W (tests compare them). Its columns are shares of the torque
   that the envelope leaves at that speed, so that every point of the map exists; losses scale with the power the
   machine is made for."
  parameter Real max_torque(unit="N.m", min=1, max=1000) = 310 "Largest torque either way";
  parameter Real max_power(unit="W", min=1000, max=500000) = 150000 "Largest power of the shaft either way";
  parameter Real speed_axis[13](each unit="rad/s") = {0, 50, 100, 200, 300, 400, 484, 600, 750, 900, 1100, 1350, 1700} "Speeds of the rows";
  parameter Real share_axis[13] = {-1, -0.75, -0.5, -0.3, -0.15, -0.05, 0, 0.05, 0.15, 0.3, 0.5, 0.75, 1} "Torque over its limit";
  parameter Real map_power(unit="W", min=1) = 150000 "Power of the machine whose losses the map shows";
  parameter Real loss_map[13, 13] = [
    7215, 4493, 2393, 1161, 498, 181, 60, 181, 498, 1161, 2393, 4493, 7215;
    7310, 4568, 2454, 1215, 549, 231, 110, 231, 549, 1215, 2454, 4568, 7310;
    7418, 4654, 2524, 1276, 607, 288, 167, 288, 607, 1276, 2524, 4654, 7418;
    7673, 4857, 2690, 1423, 746, 425, 303, 425, 746, 1423, 2690, 4857, 7673;
    7981, 5102, 2891, 1602, 915, 591, 469, 591, 915, 1602, 2891, 5102, 7981;
    8341, 5390, 3127, 1812, 1114, 786, 664, 786, 1114, 1812, 3127, 5390, 8341;
    8678, 5663, 3352, 2012, 1304, 973, 850, 973, 1304, 2012, 3352, 5663, 8678;
    6642, 4540, 2978, 2013, 1491, 1239, 1142, 1239, 1491, 2013, 2978, 4540, 6642;
    5673, 3946, 2747, 2076, 1738, 1616, 1600, 1616, 1738, 2076, 2747, 3946, 5673;
    5431, 3989, 3010, 2497, 2270, 2200, 2191, 2200, 2270, 2497, 3010, 3989, 5431;
    5517, 4350, 3578, 3191, 3028, 2979, 2973, 2979, 3028, 3191, 3578, 4350, 5517;
    5840, 4904, 4296, 3997, 3873, 3837, 3832, 3837, 3873, 3997, 4296, 4904, 5840;
    6386, 5654, 5185, 4958, 4864, 4836, 4832, 4836, 4864, 4958, 5185, 5654, 6386] "Losses of machine and inverter in W, at (speed, share of the torque limit)";
  input Real torque_demand(unit="N.m") "At the shaft";
  input Real shaft_speed(unit="rad/s");
  output Real torque(unit="N.m") "On the shaft";
  output Real electric_power(unit="W") "Taken from the link";
  output Real loss(unit="W") "Of machine and inverter";
protected
  Real torque_limit(unit="N.m");
  Boolean is_fast(start=false) "Above the corner of the envelope";
equation
  is_fast = max_torque * abs(shaft_speed) > max_power;
  torque_limit = if is_fast then max_power / abs(shaft_speed) else max_torque;
  torque = if torque_demand > torque_limit then torque_limit elseif torque_demand < -torque_limit then -torque_limit else torque_demand;
  loss = max_power / map_power * Tables.smooth2D(abs(shaft_speed), torque / torque_limit, speed_axis, share_axis, loss_map, Tables.Extrapolation.hold);
  electric_power = torque * shaft_speed + loss;
end EfficiencyMap;
