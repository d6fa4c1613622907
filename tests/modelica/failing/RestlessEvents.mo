// fails: event iteration
model RestlessEvents
  Boolean a(start = false, fixed = true);
  output Real y;
equation
  a = if time > 0.5 then not pre(a) else false;
  y = if a then 1 else 0;
end RestlessEvents;
