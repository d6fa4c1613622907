// Ideal diodes whose relations are zero on both sides of the switch, and a loop that jumps where its input does.
model DiodeBridge
  parameter Real goff = 1e-3;
  parameter Real ron = 1e-3;
  Real u = 10*sin(6*time);
  Real s[4](each start = 0);
  Real v[4];
  Real i[4];
  Real current;
  Real a;
  Real b;
  Boolean off[4](each start = true);
  output Real load;
  output Real gate;
equation
  for k in 1:4 loop
    off[k] = s[k] < 0;
    v[k] = s[k]*(if off[k] then 1 else ron);
    i[k] = s[k]*(if off[k] then goff else 1);
  end for;
  v[1] = u - a;
  v[2] = -a;
  v[3] = b - u;
  v[4] = b;
  i[1] + i[2] = load;
  i[3] + i[4] = load;
  load = (a - b)/5;
  current = if time < 0.5 then 0.05 else 0;
  gate = smooth(0, noEvent(if gate < 0.65 then 140*current else 0.6 + 10*current));
end DiodeBridge;
