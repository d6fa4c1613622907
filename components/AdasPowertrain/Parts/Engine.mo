within AdasPowertrain.Parts;
model Engine
  "Petrol engine without its inertia: runs, with idle governor, while it is on and torque is demanded; else it is dragged.
   There is no starter: something must turn it to 60 rad/s"
  extends Engines.Engine;
  parameter Real governor(unit = "N.m.s/rad", min = 0, max = 3) = 1.5
    "Torque per speed missing to idle; stable with 10 ms steps";
  Interfaces.RealInput shaft_speed(unit = "rad/s", start = 0);
  input Boolean on(start = true) "Fuel is allowed";
protected
  constant Real dead(unit = "rad/s") = 40 "Below it nothing burns";
  constant Real alive(unit = "rad/s") = 60 "From it on all burns";
  Boolean is_running;
  Real burning "0 to 1";
  Real air(unit = "N.m", start = 0, fixed = true) "Torque the air in the cylinders allows";
  Real idle(unit = "N.m") "Torque of the combustion that keeps the engine running";
  Real target(unit = "N.m") "Of the air";
equation
  speed = shaft_speed;
  is_running = on and torque_demand > 0;
  burning = min(1, max(0, (speed - dead)/(alive - dead)));
  idle = Smooth.maximum(0, drag + governor*(data.idle_speed - speed), rounding);
  target = if is_running then
    max(0, Smooth.minimum(highest, max(wanted, idle), rounding)) else 0;
  data.air_lag*der(air) = target - air;
  combustion = if is_running then burning*air else 0;
end Engine;
