within AdasPowertrain.Engines;
model Dynamic "Engine with inertia, lag of the air path, idle governor and fuel cut in overrun"
  extends Engine;
  parameter Real initial_speed(unit = "rad/s", min = 0) = data.idle_speed;
  parameter Real inertia(unit = "kg.m2", min = 0) = data.inertia;
  parameter Real governor(unit = "N.m.s/rad", min = 0) = 1.5 "Torque per speed missing to idle; a droop remains under load";
  parameter Real cut_speed(unit = "rad/s") = 140 "Above it the fuel may be cut";
  parameter Real resume_speed(unit = "rad/s") = 115 "Fuel injection resumes below it";
  Interfaces.RotationalFlange flange "Crankshaft";
  Boolean is_cut(start = false, fixed = true) "No fuel";
  Real energy(unit = "J") "Kinetic";
protected
  constant Real least(unit = "N.m") = 1 "Less combustion than this is cut";
  Real angle(unit = "rad", start = 0, fixed = true);
  Real air(unit = "N.m", start = 0, fixed = true) "Torque the air in the cylinders allows";
  Real idle(unit = "N.m") "Torque of the combustion that keeps the engine running";
  Real target(unit = "N.m") "Of the air";
equation
  flange.phi = angle;
  der(angle) = speed;
  inertia*der(speed) = torque + flange.tau;
  energy = 0.5*inertia*speed*speed;
  idle = Smooth.maximum(0, drag + governor*(data.idle_speed - speed), rounding);
  target = Smooth.minimum(highest, max(wanted, idle), rounding);
  data.air_lag*der(air) = target - air;
  is_cut = if pre(is_cut) then speed > resume_speed and target < 2*least 
    else speed > cut_speed and air < least and target < least;
  combustion = if is_cut then 0 else max(0, air);
initial equation
  speed = initial_speed;
end Dynamic;
