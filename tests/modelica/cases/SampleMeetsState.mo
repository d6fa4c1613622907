// A sample tick, a time event and a state event that fall together at 0.5.
model SampleMeetsState
  Real x(start = 0, fixed = true);
  discrete Real by_sample(start = 0, fixed = true);
  discrete Real by_time(start = 0, fixed = true);
  discrete Real by_state(start = 0, fixed = true);
  output Real y[4];
equation
  der(x) = 1;
  when sample(0.25, 0.25) then
    by_sample = pre(by_sample) + time;
  end when;
  when time >= 0.5 then
    by_time = pre(by_time) + 1 + by_sample;
  end when;
  when x >= 0.5 then
    by_state = pre(by_state) + 1;
    reinit(x, 0);
  end when;
  y = {x, by_sample, by_time, by_state};
end SampleMeetsState;
