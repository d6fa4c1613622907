within AdasPowertrain.Driveline;
model LimitedSlipDifferential
  "Final drive and bevel gears with plates between the wheels, pressed by springs and by the torque on the carrier. They
   stick up to their capacity preload + locking*|torque|, and move that much torque to the slower wheel beyond it
   (W. F. Milliken, D. L. Milliken: Race Car Vehicle Dynamics, SAE 1995, chapter 20)"
  extends Interfaces.ThreeFlanges;
  parameter Real ratio(min = 0) "Turns of a per mean turn of the wheels";
  parameter Real initial_speed(unit = "rad/s") = 0 "Of the wheels";
  parameter Real preload(unit = "N.m", min = 1, max = 1000) = 80 "Moved from wheel to wheel without any torque on the carrier; > 0";
  parameter Real locking(min = 0, max = 1) = 0.35 "Torque that can be moved from wheel to wheel against that on the carrier";
  parameter Real side_inertia(unit = "kg.m2", min = 1e-3) = 0.02 "Of each side gear with its plates";
  parameter Real plate_lag(unit = "s", min = 1e-4) = 5e-3 "Time constant of the plates' pressure";
  Real slip(unit = "rad/s") "Of the left wheel against the right one";
  Real carrier_torque(unit = "N.m") "On both wheels together";
  Real moved(unit = "N.m") "From the left wheel to the right one";
  Real loss_power(unit = "W") "Of the plates";
  Real energy(unit = "J") "Kinetic, of the side gears";
  OpenDifferential gears(ratio = ratio);
  Inertia left_gear(inertia = side_inertia, initial_speed = initial_speed);
  Inertia right_gear(inertia = side_inertia, initial_speed = initial_speed);
  Couplings.Clutch plates(capacity = preload + locking*pressing, initial_mode = 0);
protected
  Real pressing(unit = "N.m", start = 0, fixed = true) "Torque that presses the plates";
equation
  connect(a, gears.a);
  connect(gears.left, left_gear.a);
  connect(gears.right, right_gear.a);
  connect(left_gear.b, left);
  connect(right_gear.b, right);
  connect(left_gear.b, plates.a);
  connect(right_gear.b, plates.b);
  carrier_torque = gears.carrier_torque;
  slip = plates.slip;
  moved = plates.torque;
  plate_lag*der(pressing) = abs(carrier_torque) - pressing;
  loss_power = plates.loss_power;
  energy = left_gear.energy + right_gear.energy;
end LimitedSlipDifferential;
