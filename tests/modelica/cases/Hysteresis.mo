// A thermostat: a Boolean that remembers itself switches a heater; the plant is continuous.
model Hysteresis
  parameter Real low = 19;
  parameter Real high = 21;
  Real T(start = 15, fixed = true);
  Boolean heating(start = true, fixed = true);
  output Real y;
  output Boolean on;
equation
  heating = T < low or pre(heating) and T < high;
  der(T) = (if heating then 30 else 5) - T;
  y = T;
  on = heating;
end Hysteresis;
