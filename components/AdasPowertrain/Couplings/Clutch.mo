within AdasPowertrain.Couplings;
model Clutch "Dry friction that sticks: slips at its capacity, holds what is below it"
  extends Interfaces.TwoFlanges;
  parameter Integer initial_mode = 1 "As mode";
  parameter Real start_speed(unit = "rad/s", min = 0) = 1e-4 "Slip from which it counts as slipping";
  Interfaces.RealInput capacity(unit = "N.m") "Greatest torque, >= 0";
  Real slip(unit = "rad/s") "Of a against b";
  Real torque(unit = "N.m") "From a to b";
  Integer mode(start = initial_mode, fixed = true)
    "0 locked, 1 slipping forwards, 2 about to do so, -1 and -2 backwards";
  Real loss_power(unit = "W") "Heat of the slip";
protected
  constant Real far = 1e9 "What is never reached: in each mode only what ends it is watched";
  constant Real still(unit = "rad/s2") = 1e-3 "Less than this is no acceleration";
  Real slip_rate(unit = "rad/s2");
  Real hold(unit = "N.m") "It lets go beyond";
  Real rise(unit = "rad/s") "Slip that, from below, ends the mode";
  Real fall(unit = "rad/s") "Slip that, from above, ends the mode";
  Real back(unit = "rad/s2") "Acceleration against the coming slip that ends the mode";
equation
  slip = der(a.phi) - der(b.phi);
  slip_rate = der(slip);
  a.tau = torque;
  b.tau = -torque;
  hold = if pre(mode) == 0 then capacity else far;
  rise = if pre(mode) == 2 then start_speed elseif pre(mode) == -1 then 0 else far;
  fall = if pre(mode) == -2 then -start_speed elseif pre(mode) == 1 then 0 else -far;
  back = if abs(pre(mode)) == 2 then still else far;
  mode =
    if pre(mode) == 0 then (if torque > hold then 2 elseif torque < -hold then -2 else 0)
    elseif pre(mode) == 2 then (if slip > rise then 1 elseif slip_rate < -back then 0 else 2)
    elseif pre(mode) == -2 then (if slip < fall then -1 elseif slip_rate > back then 0 else -2)
    elseif pre(mode) == 1 then (if slip < fall then 0 else 1)
    else (if slip > rise then 0 else -1);
  0 = if mode == 0 then slip_rate elseif mode > 0 then torque - capacity else torque + capacity;
  loss_power = torque*slip;
end Clutch;
