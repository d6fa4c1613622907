// Booleans that several conditions set: in branches of a when-clause, in a vector of conditions, and each by the other.
model BooleanUnderConditions
  parameter Real period = 0.1;
  Boolean on(start = false, fixed = true);
  Boolean late(start = false, fixed = true);
  Boolean both;
  Integer count(start = 0, fixed = true);
  output Real y[4];
equation
  when {time > 0.25, time > 0.65, late} then
    on = not pre(on);
  elsewhen time > 0.45 then
    on = if pre(count) > 3 then false else pre(on);
  end when;
  when sample(period, period) then
    count = pre(count) + 1;
    if pre(count) > 4 and pre(on) then
      late = true;
    elseif pre(count) > 7 then
      late = false;
    else
      late = pre(late);
    end if;
  end when;
  both = on and not late;
  y = {if on then 1 else 0, if late then 1 else 0, if both then 1 else 0, count};
end BooleanUnderConditions;
