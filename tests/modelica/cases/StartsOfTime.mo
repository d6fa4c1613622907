// Initial values that depend on time: A saw tooth that counts its periods, and memories of the start: initial values that depend on time.
model StartsOfTime
  parameter Real period = 0.4;
  parameter Real begin = -0.5;
  output Real y;
  output Integer count;
  output Real since;
  output Real x(start = time + 2, fixed = true);
protected
  Real from;
  Real entered;
  Boolean fired(start = false, fixed = true);
initial algorithm
  count := integer((time - begin)/period);
  from := begin + count*period;
initial equation
  pre(entered) = time - 1;
equation
  when time >= (pre(count) + 1)*period + begin then
    count = pre(count) + 1;
    from = time;
  end when;
  when time >= 0.5 then
    entered = time;
    fired = true;
  end when;
  y = (time - from)/period;
  since = if fired or time > 2 then time - entered else (time - entered)/2;
  der(x) = -x;
end StartsOfTime;
