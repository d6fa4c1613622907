// A block on a moving floor: sticks, slips, sticks; discrete mode, reinit of nothing, events both ways.
model FrictionStickSlip
  parameter Real m = 1;
  parameter Real fs = 3;
  parameter Real fc = 2;
  Real v(start = 0, fixed = true);
  Boolean sliding(start = false, fixed = true);
  Real pull;
  output Real speed;
  output Boolean slips;
equation
  pull = 4 * sin(3.141592653589793 * time);
  sliding = pre(sliding) and (v > 0 or pull > fc) or not pre(sliding) and pull > fs;
  m * der(v) = if sliding then pull - fc else 0;
  speed = v;
  slips = sliding;
end FrictionStickSlip;
