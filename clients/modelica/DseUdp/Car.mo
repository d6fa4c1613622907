within DseUdp;
model Car "The near half: asked by nobody for a datagram, so that every tool translates it"
  parameter Real gain(unit = "N/m") = 300 "of the force on the gap that is left";
  parameter Real damping(unit = "N.s/m") = 1500 "of the force on the speed";
  parameter Real lag(unit = "s") = 0.2 "of the drive";
  parameter Real target(unit = "m") = 5 "gap to stop at";
  input Real place(unit = "m") "told by the world";
  input Real speed(unit = "m/s") "told by the world";
  input Real gap(unit = "m") "told by the world";
  output Real force(unit = "N", start = 0, fixed = true) "told to the world";
equation
  lag * der(force) = gain * (gap - target) - damping * speed - force;
end Car;
