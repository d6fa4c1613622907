within AdasPowertrain.Driveline;
model HalfShafts
  "From a differential to wheels whose speeds are given. Two shafts of 30 kN.m/rad between an engine in first or second
   gear and a car shuffle at 4 to 8 Hz: (stiffness*2*(1/J_engine + 1/J_car))^0.5/(2*pi), both inertias at the wheels.
   DriveShaft says which communication steps are stable"
  parameter Real stiffness(unit = "N.m/rad", min = 0) = 30e3 "Of each";
  parameter Real damping(unit = "N.m.s/rad", min = 0) = 150 "Of each";
  Interfaces.RotationalFlange a "From the left side of the differential";
  Interfaces.RotationalFlange b "From the right side of the differential";
  Interfaces.RealInput speed_left(unit = "rad/s");
  Interfaces.RealInput speed_right(unit = "rad/s");
  Interfaces.RealOutput torque_left(unit = "N.m") "Drives the wheel if > 0";
  Interfaces.RealOutput torque_right(unit = "N.m") "Drives the wheel if > 0";
  Real loss_power(unit = "W");
  Real energy(unit = "J") "Elastic";
  DriveShaft left(stiffness = stiffness, damping = damping);
  DriveShaft right(stiffness = stiffness, damping = damping);
  Wheels wheel_left(speed = speed_left);
  Wheels wheel_right(speed = speed_right);
equation
  connect(a, left.a);
  connect(b, right.a);
  connect(left.b, wheel_left.flange);
  connect(right.b, wheel_right.flange);
  torque_left = wheel_left.torque;
  torque_right = wheel_right.torque;
  loss_power = left.loss_power + right.loss_power;
  energy = left.energy + right.energy;
end HalfShafts;
