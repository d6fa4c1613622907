within AdasPowertrain.Gearboxes;
model SteppedGear
  "Gears changed under power. During a shift the clutches lead the input from the old gear's speed to the new one's while
   one of them slips (ShiftSchedule has the phases; the clutches are controlled ideally: their torque is what moves the
   input as planned). Nothing is lost but mesh losses, drag and the heat of the slip"
  extends Interfaces.TwoFlanges;
  parameter Vehicles.GearboxData data;
  parameter Real initial_speed(unit = "rad/s", min = 0) = 0 "Of the output";
  parameter Real max_power(unit = "W") "Full load, for the shift schedule";
  Interfaces.RealInput wheel_speed(unit = "rad/s") "Driven axle";
  Interfaces.RealInput power_demand(unit = "W");
  Real input_speed(unit = "rad/s");
  Real output_speed(unit = "rad/s", start = initial_speed, fixed = true, stateSelect = StateSelect.prefer);
  Real loss_power(unit = "W") "Meshes, drag and slip of shifts";
  Real energy(unit = "J") "Kinetic";
  ShiftSchedule schedule(
    data = data,
    initial_speed = initial_speed,
    max_power = max_power,
    output_speed = wheel_speed*data.final_ratio,
    power = power_demand,
    is_driving = is_driving);
protected
  constant Real standing(unit = "rad/s") = 1 "Losses against the rotation fall to zero below";
  Real angle_in(unit = "rad", start = 0, fixed = true);
  Real angle_out(unit = "rad", start = 0, fixed = true);
  constant Real idling(unit = "N.m") = 1e-3 "No torque to speak of";
  Real torque(unit = "N.m") "Into the gears";
  Boolean is_driving(start = true, fixed = true) "The input drives the output";
  Real mesh(unit = "N.m") "Loss of the meshes, as torque at the input";
  Real drag(unit = "N.m");
  Real torque_ratio "Output against input, before mesh losses";
equation
  angle_in = a.phi;
  angle_out = b.phi;
  input_speed = der(angle_in);
  output_speed = der(angle_out);
  input_speed = schedule.ratio*output_speed;
  is_driving = torque > (if pre(is_driving) then -idling else idling);
  torque_ratio = if is_driving then schedule.driving else schedule.overrun;
  mesh = (1 - data.efficiency)*(if is_driving then torque else -torque)*Smooth.direction(output_speed, standing);
  drag = data.drag*Smooth.direction(input_speed, standing);
  data.inertia_in*der(input_speed) = a.tau - drag - torque;
  data.inertia_out*der(output_speed) = b.tau + torque_ratio*(torque - mesh);
  loss_power = drag*input_speed + torque*(input_speed - torque_ratio*output_speed) + torque_ratio*mesh*output_speed;
  energy = 0.5*data.inertia_in*input_speed*input_speed + 0.5*data.inertia_out*output_speed*output_speed;
end SteppedGear;
