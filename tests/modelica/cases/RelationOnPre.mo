// A relation whose limit depends on the value before: hysteresis written as one comparison.
model RelationOnPre
  parameter Real band = 0.5;
  Real x;
  Boolean up(start = false, fixed = true);
  Real area(start = 0, fixed = true);
  Integer switches(start = 0, fixed = true);
  output Boolean on;
  output Real y;
  output Integer n;
equation
  x = sin(7 * time);
  up = x > (if pre(up) then -band else band);
  der(area) = if up then 1 else -1;
  when change(up) then
    switches = pre(switches) + 1;
  end when;
  on = up;
  y = area;
  n = switches;
end RelationOnPre;
