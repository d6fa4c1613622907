// Several when-statements of an algorithm that assign one variable: of those at one instant, the last one holds.
model SeveralWhens
  parameter Real second = 0.4;
  discrete Integer n(start = 0, fixed = true);
  discrete Boolean on(start = false, fixed = true);
  output Integer count;
  output Real lit;
algorithm
  when time >= 0.2 then
    n := 1;
  elsewhen time >= second then
    n := 2;
  end when;
  when {time >= 0.6, time >= 0.8} then
    on := false;
  end when;
  when time >= 0.4 then
    n := 3;
    on := true;
  elsewhen time >= 0.8 then
    n := 4;
    on := true;
  end when;
equation
  count = n;
  lit = if on then 1 else 0;
end SeveralWhens;
