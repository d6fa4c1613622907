// A state machine over an enumeration that starts in its second item.
model EnumerationMachine
  type Gear = enumeration(Park, Drive, Reverse);
  Gear gear(start = Gear.Drive, fixed = true);
  Real v(start = 0, fixed = true);
  output Gear now;
  output Real speed;
equation
  der(v) = if gear == Gear.Drive then 2 elseif gear == Gear.Reverse then -1 else 0;
  gear = if pre(gear) == Gear.Drive and v > 1 then Gear.Reverse elseif pre(gear) == Gear.Reverse and v < 0.75 then Gear.Park else pre(gear);
  now = gear;
  speed = v;
end EnumerationMachine;
