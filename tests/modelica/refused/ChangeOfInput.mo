// Boolean and integer inputs that change while the model runs: edges counted, a table of rates chosen.
model ChangeOfInput // refused: change
  input Boolean on(start = false);
  input Integer gear(start = 1);
  parameter Real rate[3] = {1, -2, 4};
  Real x(start = 0, fixed = true);
  discrete Integer starts(start = 0, fixed = true);
  discrete Integer shifts(start = 0, fixed = true);
  output Real y;
  output Integer n;
  output Integer m;
equation
  der(x) = if on then rate[gear] else 0;
  when on then
    starts = pre(starts) + 1;
  end when;
  when change(gear) then
    shifts = pre(shifts) + 1;
  end when;
  y = x;
  n = starts;
  m = shifts;
end ChangeOfInput;
