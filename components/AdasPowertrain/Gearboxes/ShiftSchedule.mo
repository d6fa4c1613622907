within AdasPowertrain.Gearboxes;
model ShiftSchedule
  "Which gear: up above, down below an input speed that grows with the load; both judged by the wheels' speed, so that
   neither converter slip nor shaft vibration shifts. A shift has two phases. In the inertia phase the ratio moves from the
   old gear's to the new one's, and the clutch whose slip has the sign of the torque transmits it: the lower gear's when
   driving, the higher gear's in overrun. In the torque phase the torque is handed over linearly, at the speed of the gear
   that does not slip. It is first if the new gear transmits in the inertia phase, else last (U. Kiencke, L. Nielsen:
   Automotive Control Systems, 2005, chapter on driveline control; H. Naunheimer et al.: Automotive Transmissions, 2011)"
  parameter Vehicles.GearboxData data;
  parameter Real initial_speed(unit = "rad/s", min = 0) = 0 "Of the output";
  parameter Real max_power(unit = "W") "Full load";
  Interfaces.RealInput output_speed(unit = "rad/s");
  Interfaces.RealInput power(unit = "W") "Demanded";
  input Boolean is_driving = true "The input drives the output";
  final parameter Integer initial_gear = 1 + sum(
    {if k < data.gears and initial_speed*data.ratios[k] > data.up_calm then 1 else 0 for k in 1:data.gears});
  Integer gear(start = initial_gear, fixed = true);
  Integer previous_gear(start = initial_gear, fixed = true);
  Boolean is_shifting;
  Real ratio "Now, input against output speed";
  Real ratio_rate(unit = "1/s") "Its derivative";
  Real driving "Ratio of the torques when driving: of one gear, or between both gears";
  Real overrun "Ratio of the torques in overrun";
protected
  discrete Real began(unit = "s", start = -1e6, fixed = true) "The last shift";
  Boolean torque_first(start = false, fixed = true) "Torque phase before inertia phase";
  Real inertia_begins(unit = "s");
  Real torque_begins(unit = "s");
  parameter Real inertia_phase(unit = "s") = max(1e-3, data.shift_time - data.torque_phase);
  Boolean is_ready "For another shift";
  Boolean wants_up(start = false, fixed = true);
  Boolean wants_down(start = false, fixed = true);
  Real load "0 to 1";
  Real up(unit = "rad/s");
  Real down(unit = "rad/s");
  Real progress "Of the inertia phase, 0 to 1";
  Real handed "Part of the torque that the new gear transmits, 0 to 1";
  Real between "Ratio of the torques while they are handed over";
  Boolean is_up;
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
    torque_first = if wants_up then is_driving else not is_driving;
  end when;
  is_shifting = time < began + data.shift_time;
  inertia_begins = if torque_first then began + data.torque_phase else began;
  torque_begins = if torque_first then began else began + inertia_phase;
  progress = (time - inertia_begins)/inertia_phase;
  part = if time < inertia_begins then 0 elseif time < inertia_begins + inertia_phase then progress*progress*(3 - 2*progress) else 1;
  ratio = data.ratios[previous_gear] + (data.ratios[gear] - data.ratios[previous_gear])*part;
  ratio_rate = if time >= inertia_begins and time < inertia_begins + inertia_phase then
    (data.ratios[gear] - data.ratios[previous_gear])*6*progress*(1 - progress)/inertia_phase else 0;
  handed = if time < torque_begins then 0
    elseif time < torque_begins + data.torque_phase then (time - torque_begins)/max(data.torque_phase, 1e-9) else 1;
  between = if is_shifting then data.ratios[previous_gear] + (data.ratios[gear] - data.ratios[previous_gear])*handed else data.ratios[gear];
  is_up = gear > previous_gear;
  driving = if not is_shifting or is_up == torque_first then between elseif is_up then data.ratios[gear] else data.ratios[previous_gear];
  overrun = if not is_shifting or is_up <> torque_first then between elseif is_up then data.ratios[previous_gear] else data.ratios[gear];
end ShiftSchedule;
