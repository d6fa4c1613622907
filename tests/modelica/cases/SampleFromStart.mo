// A sample whose ticks are counted from the start of the simulation.
model SampleFromStart
  parameter Real t0(fixed = false);
  parameter Real period = 0.2;
  discrete Real last(start = -1, fixed = true);
  discrete Integer n(start = 0, fixed = true);
  output Real at;
  output Integer count;
initial equation
  t0 = time;
equation
  when sample(t0 + 0.1, period) then
    last = time;
    n = pre(n) + 1;
  end when;
  at = last;
  count = n;
end SampleFromStart;
