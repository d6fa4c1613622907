within AdasPowertrain.Parts;
partial model HybridManagement
  "What energy managements of a P2 hybrid share: the engine never runs below its speed; it is cranked through the slipping
   clutch while the machine gives the clutch's torque in addition; the machine gives what is missing, quicker than the
   engine. A strategy finds is_wanted, is_urgent and best"
  parameter Real target_soc(min=0, max=1) = 0.5 "State of charge kept up";
  parameter Real least_time(unit="s", min=0, max=120) = 4 "The engine runs and rests at least so long, standstill excepted";
  parameter Real start_speed(unit="rad/s", min=50, max=300) = 115 "Of the machine, to start the engine";
  parameter Real stop_speed(unit="rad/s", min=50, max=300) = 92 "Of the machine, to stop it";
  parameter Real least_engine_torque(unit="N.m", min=0.1, max=100) = 10 "Asked of the running engine at least";
  parameter Real max_machine_torque(unit="N.m", min=10, max=600) = 330;
  parameter Real max_recuperation(unit="N.m", min=0, max=600) = 150 "Of the machine";
  parameter Real max_discharge_power(unit="W", min=1000, max=500000) = 90000 "Asked of any battery at most";
  parameter Real max_charge_power(unit="W", min=1000, max=500000) = 60000 "Given to any battery at most";
  parameter Real engine_lag(unit="s", min=0.01, max=5) = 0.4 "Time constant of the demand to the engine";
  parameter Real engine_response(unit="s", min=0.01, max=5) = 0.2 "Of the engine, as the machine expects it";
  parameter Real clutch_lag(unit="s", min=0.01, max=1) = 0.06 "Time constant of the clutch's command";
  parameter Real slipping(min=0, max=1) = 0.15 "Command of the clutch while it cranks";
  parameter Real cranking_torque(unit="N.m", min=0, max=300) = 45 "What the machine gives in addition meanwhile";
  parameter Real synchronous_speed(unit="rad/s", min=1, max=50) = 10 "Slip at which the clutch closes";
  Interfaces.RealInput torque_demand(unit="N.m", start=0) "At the wheels";
  Interfaces.RealInput ratio(start=15) "Speed of the machine over that of the wheels";
  Interfaces.RealInput engine_speed(unit="rad/s", start=0);
  Interfaces.RealInput machine_speed(unit="rad/s", start=0);
  Interfaces.RealInput soc(start=0.5);
  Interfaces.RealInput discharge_power(unit="W", start=1e6) "Most the battery gives now";
  Interfaces.RealInput charge_power(unit="W", start=1e6) "Most the battery takes now";
  Interfaces.RealInput machine_torque_limit(unit="N.m", start=1e4) "Most the machine gives now";
  Interfaces.RealOutput engine_torque_demand(unit="N.m") "0: off";
  Interfaces.RealOutput machine_torque_demand(unit="N.m");
  Interfaces.RealOutput clutch(start=0, fixed=true) "0 open … 1 closed";
  output Boolean is_engine_on(start=false, fixed=true);
  Machines.TorqueRequest request(ratio=1, max_torque=max_machine_torque, max_recuperation=max_recuperation);
  Batteries.PowerLimits limits(max_discharge_power=max_discharge_power, max_charge_power=max_charge_power);
protected
  Real shaft_torque(unit="N.m") "Wanted at the machine's shaft";
  Real best(unit="N.m") "Torque the running engine should give";
  Real engine_share(unit="N.m") "Torque the engine should give";
  Real engine_target(unit="N.m", start=0, fixed=true);
  Real engine_estimate(unit="N.m", start=0, fixed=true) "Torque the engine is likely to give";
  Real clutch_target;
  discrete Real changed_at(unit="s", start=-1000, fixed=true) "When the engine was started or stopped last";
  Boolean is_rested(start=true);
  Boolean is_fast(start=false, fixed=true) "Enough for the engine";
  Boolean is_wanted(start=false) "Engine";
  Boolean is_urgent(start=false) "Engine, without a rest";
  Boolean is_synchronous(start=false, fixed=true) "The clutch closes or is closed";
equation
  shaft_torque = torque_demand / ratio;
  is_fast = machine_speed > start_speed or pre(is_fast) and machine_speed > stop_speed;
  is_rested = time >= pre(changed_at) + least_time;
  is_engine_on = is_fast and (if is_rested or is_urgent then is_wanted else pre(is_engine_on));
  when change(is_engine_on) then
    changed_at = time;
  end when;
  is_synchronous = is_engine_on and (pre(is_synchronous) or abs(engine_speed - machine_speed) < synchronous_speed);
  engine_share = if is_synchronous then best else 0;
  der(engine_target) = (engine_share - engine_target) / engine_lag;
  engine_torque_demand = if is_engine_on then noEvent(max(engine_target, least_engine_torque)) else 0;
  der(engine_estimate) = (engine_target - engine_estimate) / engine_response;
  clutch_target = if is_synchronous then 1 elseif is_engine_on then slipping else 0;
  der(clutch) = (clutch_target - clutch) / clutch_lag;
  limits.soc = soc;
  request.discharge_power = noEvent(min(limits.discharge_power, discharge_power));
  request.charge_power = noEvent(min(limits.charge_power, charge_power));
  request.machine_speed = machine_speed;
  request.torque_demand = shaft_torque - engine_estimate + (if is_engine_on and not is_synchronous then cranking_torque else 0);
  machine_torque_demand = request.machine_torque_demand;
end HybridManagement;
