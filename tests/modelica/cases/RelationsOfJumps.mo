// Relations of variables that jump at the same event are of one solution with them: there is no pass between.
model RelationsOfJumps
  parameter Real T = 0.5;
  Boolean late = time > T;
  Real level = if late then 1 else 0;
  Boolean high = level > 0.5;
  Integer step = if late then 3 else 1;
  Real choice = if level > 0.5 then 10 else 20;
  output Integer never(start = 0, fixed = true);
  output Integer once(start = 0, fixed = true);
  output Integer never_too(start = 0, fixed = true);
  output Real caught(start = 0, fixed = true);
equation
  when late and not high then
    never = pre(never) + 1;
  end when;
  when high then
    once = pre(once) + 1;
  end when;
  when late and not step >= 2 then
    never_too = pre(never_too) + 1;
  end when;
  when late then
    caught = choice;
  end when;
end RelationsOfJumps;
