// A pulse without events, which steps of the solver must not leave out.
model NoEventPulse
  Real x(start = 0, fixed = true);
  output Real y = x;
equation
  der(x) = noEvent(if sin(2*3.14159265358979324*time) > 0 then 2 else 0);
end NoEventPulse;
