model Truck "Point mass with air drag on a level road"
  parameter Real mass(unit = "kg", min = 1) = 4000 "Mass";
  parameter Real drag(unit = "kg/m", min = 0) = 3 "Force of the air relative to the square of the speed";
  input Real force(unit = "N");
  output Real speed(unit = "m/s", start = 10, fixed = true);
equation
  mass*der(speed) = force - drag*speed*abs(speed);
end Truck;
