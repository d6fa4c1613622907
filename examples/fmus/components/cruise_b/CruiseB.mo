model CruiseB "P cruise control"
  parameter Real kp(unit = "N.s/m", min = 0) = 5000 "P gain";
  input Real speed(unit = "m/s");
  input Real set_speed(unit = "m/s");
  output Real force(unit = "N");
equation
  force = max(-8000, min(8000, kp*(set_speed - speed)));
end CruiseB;
