within AdasPowertrain.Engines;
model Dynamic "Engine with inertia, lag of the air path, idle governor and fuel cut in overrun"
  extends Engine;
  parameter Real initial_speed(unit = "rad/s", min = 0) = data.idle_speed;
  parameter Real inertia(unit = "kg.m2", min = 0) = data.inertia;
  parameter Real governor(unit = "N.m.s/rad", min = 0) = 1.5 "Torque per speed missing to idle; a droop remains under load";
  parameter Boolean has_stop_start = false "It stops where may_stop says so, and is started again";
  parameter Real starter_torque(unit = "N.m", min = 10, max = 300) = 80 "At the crankshaft, at rest";
  parameter Real starter_speed(unit = "rad/s", min = 50) = 90 "At which the starter has no torque left";
  parameter Real starter_efficiency(min = 0.1, max = 1) = 0.8 "Of its gears; its resistance is counted besides";
  input Boolean may_stop = false "Standstill, and nothing demanded";
  Real electric_power(unit = "W") "Of the starter, and of the auxiliaries while the engine stands";
  parameter Real cut_speed(unit = "rad/s") = 140 "Above it the fuel may be cut";
  parameter Real resume_speed(unit = "rad/s") = 115 "Fuel injection resumes below it";
  Interfaces.RotationalFlange flange "Crankshaft";
  Boolean is_cut(start = false, fixed = true) "No fuel";
  Real energy(unit = "J") "Kinetic";
  Real starter_loss(unit = "W") "Of the starter, and what the auxiliaries take meanwhile";
  Boolean is_stopped(start = false, fixed = true);
  Boolean is_starting(start = false, fixed = true) "By the starter";
protected
  constant Real dead(unit = "rad/s") = 20 "Below it nothing burns while it is started; direct injection fires within the first turns";
  constant Real alive(unit = "rad/s") = 60 "From it on all burns";
  Real starter(unit = "N.m") "On the crankshaft";
  Real burning "0 to 1";
  constant Real least(unit = "N.m") = 1 "Less combustion than this is cut";
  Real angle(unit = "rad", start = 0, fixed = true);
  Real air(unit = "N.m", start = 0, fixed = true) "Torque the air in the cylinders allows";
  Real idle(unit = "N.m") "Torque of the combustion that keeps the engine running";
  Real target(unit = "N.m") "Of the air";
equation
  flange.phi = angle;
  der(angle) = speed;
  inertia*der(speed) = torque + starter + flange.tau;
  is_stopped = has_stop_start and may_stop;
  is_starting = has_stop_start and not is_stopped and speed < (if pre(is_starting) then alive else dead);
  starter = if is_starting then starter_torque*noEvent(max(0, 1 - speed/starter_speed)) else 0;
  electric_power = starter*starter_speed/starter_efficiency + (if is_stopped then scale*data.auxiliary_power else 0);
  starter_loss = electric_power - starter*speed;
  burning = if has_stop_start then noEvent(min(1, max(0, (speed - dead)/(alive - dead)))) else 1;
  energy = 0.5*inertia*speed*speed;
  idle = Smooth.maximum(0, drag + governor*(data.idle_speed - speed), rounding);
  target = Smooth.minimum(highest, max(wanted, idle), rounding);
  data.air_lag*der(air) = target - air;
  is_cut = if pre(is_cut) then speed > resume_speed and target < 2*least 
    else speed > cut_speed and air < least and target < least;
  combustion = if is_cut or is_stopped then 0 else burning*max(0, air);
initial equation
  speed = initial_speed;
end Dynamic;
