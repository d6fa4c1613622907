// A root of the level, valid only while there is a level: the trial step beyond the event must not spoil the run.
model RootBeyondEvent
  parameter Real leak = 0.1;
  Real h(start = 1, fixed = true);
  Real emptied(start = 0, fixed = true);
  output Real y;
  output Real z;
equation
  der(h) = if h > 0 then -sqrt(h) - leak else 0;
  der(emptied) = if h > 0 then 0 else 1;
  y = h;
  z = emptied;
end RootBeyondEvent;
