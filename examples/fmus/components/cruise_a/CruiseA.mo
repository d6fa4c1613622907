model CruiseA "PI cruise control; the integrator also works while the force is limited"
  parameter Real kp(unit = "N.s/m", min = 0) = 2000 "P gain";
  parameter Real ki(unit = "N/m", min = 0) = 100 "I gain";
  input Real speed(unit = "m/s");
  input Real set_speed(unit = "m/s");
  output Real force(unit = "N");
  Real integral(unit = "N", start = 0, fixed = true);
equation
  der(integral) = ki*(set_speed - speed);
  force = max(-6000, min(6000, kp*(set_speed - speed) + integral));
end CruiseA;
