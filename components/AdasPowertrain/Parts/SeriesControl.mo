within AdasPowertrain.Parts;
model SeriesControl
  "Energy management of a range extender: a band of the state of charge, three operating points, least running time.
   Thermostat with load following: Guzzella and Sciarretta, Vehicle Propulsion Systems, 2013, ch. 7.3."
  parameter Real ratio(min=2, max=20) = 9.665 "Speed of the machine over that of the wheels";
  parameter Real max_torque(unit="N.m", min=10, max=600) = 330 "Of the machine";
  parameter Real max_recuperation(unit="N.m", min=0, max=600) = 150 "Of the machine";
  parameter Real max_discharge_power(unit="W", min=1000, max=500000) = 130000 "Of the battery";
  parameter Real max_charge_power(unit="W", min=1000, max=500000) = 60000 "Of the battery";
  parameter Real start_soc(min=0, max=1) = 0.48 "The generator starts below";
  parameter Real stop_soc(min=0, max=1) = 0.52 "The generator stops above";
  parameter Real least_time(unit="s", min=0, max=600) = 20 "The generator runs at least so long, and rests at least so long";
  parameter Real averaging(unit="s", min=1, max=300) = 20 "Time constant of the mean traction power";
  parameter Real point_power[3](each unit="W") = {8000, 14000, 22000} "Electric powers of the generator's operating points";
  parameter Real point_band(unit="W", min=0) = 1000 "Half of the hysteresis between the points";
  Interfaces.RealInput torque_demand(unit="N.m", start=0) "At the wheels";
  Interfaces.RealInput motor_speed(unit="rad/s", start=0);
  Interfaces.RealInput soc(start=0.5);
  Interfaces.RealOutput machine_torque_demand(unit="N.m");
  Interfaces.RealOutput generator_power_demand(unit="W");
  output Boolean is_charging(start=false, fixed=true) "Whether the generator is asked for power";
  output Integer point(start=1, fixed=true) "Operating point";
  Machines.TorqueRequest request(ratio=ratio, max_torque=max_torque, max_recuperation=max_recuperation);
  Batteries.PowerLimits limits(max_discharge_power=max_discharge_power, max_charge_power=max_charge_power);
protected
  Real mean_power(unit="W", start=0, fixed=true, nominal=1000) "Of traction";
  discrete Real changed_at(unit="s", start=-1000, fixed=true) "When the generator was started or stopped last";
  Boolean is_rested(start=true);
  Boolean is_low(start=false, fixed=true);
  Boolean is_above[2](each start=false, each fixed=true) "Whether the mean power is above what points 1 and 2 give";
equation
  request.torque_demand = torque_demand;
  request.machine_speed = motor_speed;
  request.discharge_power = limits.discharge_power;
  request.charge_power = limits.charge_power;
  limits.soc = soc;
  machine_torque_demand = request.machine_torque_demand;
  der(mean_power) = (request.machine_torque_demand * motor_speed - mean_power) / averaging;
  is_low = soc < start_soc or pre(is_low) and soc < stop_soc;
  is_rested = time >= pre(changed_at) + least_time;
  is_charging = if is_rested then is_low else pre(is_charging);
  when change(is_charging) then
    changed_at = time;
  end when;
  for k in 1:2 loop
    is_above[k] = mean_power > point_power[k] + point_band or pre(is_above[k]) and mean_power > point_power[k] - point_band;
  end for;
  point = if is_above[2] then 3 elseif is_above[1] then 2 else 1;
  generator_power_demand = if is_charging then point_power[point] else 0;
end SeriesControl;
