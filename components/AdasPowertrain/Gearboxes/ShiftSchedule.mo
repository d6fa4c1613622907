within AdasPowertrain.Gearboxes;
model ShiftSchedule
  "Which gear: up above, down below an input speed that grows with the load; both judged by the wheels' speed, so that
   neither converter slip nor shaft vibration shifts. During a shift the ratio moves from the old gear's to the new one's"
  parameter Vehicles.GearboxData data;
  parameter Real initial_speed(unit = "rad/s", min = 0) = 0 "Of the output";
  parameter Real max_power(unit = "W") "Full load";
  Interfaces.RealInput output_speed(unit = "rad/s");
  Interfaces.RealInput power(unit = "W") "Demanded";
  final parameter Integer initial_gear = 1 + sum(
    {if k < data.gears and initial_speed*data.ratios[k] > data.up_calm then 1 else 0 for k in 1:data.gears});
  Integer gear(start = initial_gear, fixed = true);
  Integer previous_gear(start = initial_gear, fixed = true);
  Boolean is_shifting;
  Real ratio "Now, input against output speed";
  Real higher "The greater of the two gears' ratios while shifting, else the ratio";
  Real lower "The smaller of the two gears' ratios while shifting, else the ratio";
protected
  discrete Real began(unit = "s", start = -1e6, fixed = true) "The last shift";
  Boolean is_ready "For another shift";
  Boolean wants_up(start = false, fixed = true);
  Boolean wants_down(start = false, fixed = true);
  Real load "0 to 1";
  Real up(unit = "rad/s");
  Real down(unit = "rad/s");
  Real progress "Of the shift, 0 to 1";
  Real part "Of the way to the new ratio";
equation
  load = min(1, max(0, power/max_power));
  up = data.up_calm + (data.up_full - data.up_calm)*load;
  down = data.down_calm + (data.down_full - data.down_calm)*load;
  is_ready = time > pre(began) + data.shift_time + data.dwell;
  wants_up = is_ready and pre(gear) < data.gears and output_speed*data.ratios[pre(gear)] > up;
  wants_down = is_ready and pre(gear) > 1 and output_speed*data.ratios[pre(gear)] < down;
  when {wants_up, wants_down} then
    gear = if wants_up then pre(gear) + 1 else pre(gear) - 1;
    previous_gear = pre(gear);
    began = time;
  end when;
  is_shifting = time < began + data.shift_time;
  progress = (time - began)/data.shift_time;
  part = if is_shifting then progress*progress*(3 - 2*progress) else 1;
  ratio = data.ratios[previous_gear] + (data.ratios[gear] - data.ratios[previous_gear])*part;
  higher = if is_shifting then max(data.ratios[gear], data.ratios[previous_gear]) else data.ratios[gear];
  lower = if is_shifting then min(data.ratios[gear], data.ratios[previous_gear]) else data.ratios[gear];
end ShiftSchedule;
