model SampleOfVariablePeriod
  Real period;
  discrete Integer n(start = 0, fixed = true);
  output Integer y;
equation
  period = 0.1 + time;
  when sample(0, period) then // refused: sample
    n = pre(n) + 1;
  end when;
  y = n;
end SampleOfVariablePeriod;
