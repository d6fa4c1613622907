// Steps, pulses and a ramp from conditions on time, given as plain expressions; integrated.
model TimeEvents
  parameter Real t0 = 0.2;
  parameter Real width = 0.05;
  Real pulse;
  Real ramp;
  Real x(start = 0, fixed = true);
  output Real y;
  output Real z;
equation
  pulse = if time >= t0 and time < t0 + width then 20 else 0;
  ramp = if time < 0.5 then 0 elseif time < 0.7 then 10 * (time - 0.5) else 2;
  der(x) = pulse + ramp;
  y = x;
  z = ramp;
end TimeEvents;
