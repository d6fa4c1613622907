within AdasPowertrain.Gearboxes;
model LockUpSchedule "Whether the converter's clutch is closed: from a gear and an input speed on"
  parameter Integer from_gear(min = 1) = 2;
  parameter Real closing_speed(unit = "rad/s") = 130;
  parameter Real opening_speed(unit = "rad/s") = 105;
  parameter Boolean starts_closed = false;
  Interfaces.RealInput input_speed(unit = "rad/s") "Of the gearbox behind the converter";
  input Integer gear;
  Boolean is_closed(start = starts_closed, fixed = true);
equation
  is_closed = gear >= from_gear and input_speed > (if pre(is_closed) then opening_speed else closing_speed);
end LockUpSchedule;
