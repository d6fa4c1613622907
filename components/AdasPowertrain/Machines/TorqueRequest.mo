within AdasPowertrain.Machines;
block TorqueRequest
  "From the torque wanted at the wheels to the one asked of the machine, within what the battery gives and takes.
   Recuperation fades out towards standstill, where it would cost energy, like in every series car. Forward driving."
  parameter Real ratio(min=0.5, max=30) = 11.53 "Speed of the machine over that of the wheels";
  parameter Real max_torque(unit="N.m", min=1, max=1000) = 310 "Of the machine, driving";
  parameter Real max_recuperation(unit="N.m", min=0, max=1000) = 150 "Of the machine, recuperating";
  parameter Real fading_speed(unit="rad/s", min=0.1, max=200) = 30 "Of the machine, at which half of the recuperation is left";
  parameter Real usable_power(min=0.1, max=1) = 0.9 "Shaft power over battery power, for the limit when driving";
  input Real torque_demand(unit="N.m") "At the wheels";
  input Real machine_speed(unit="rad/s");
  input Real discharge_power(unit="W") "Most the battery gives";
  input Real charge_power(unit="W") "Most the battery takes";
  output Real machine_torque_demand(unit="N.m");
  Real highest(unit="N.m") "Asked of the machine at most";
  Real lowest(unit="N.m") "Asked of the machine at least";
protected
  Real size(unit="rad/s") "Of the speed, smooth and never zero";
  Real fading;
  Real wanted(unit="N.m");
  Boolean is_driving_limited(start=false);
  Boolean is_charging_limited(start=false);
equation
  size = sqrt(machine_speed ^ 2 + 1);
  fading = machine_speed ^ 2 / (machine_speed ^ 2 + fading_speed ^ 2);
  is_driving_limited = max_torque * size > usable_power * discharge_power;
  highest = if is_driving_limited then usable_power * discharge_power / size else max_torque;
  is_charging_limited = max_recuperation * size > charge_power;
  lowest = -fading * (if is_charging_limited then charge_power / size else max_recuperation);
  wanted = torque_demand / ratio;
  machine_torque_demand = if wanted > highest then highest elseif wanted < lowest then lowest else wanted;
end TorqueRequest;
