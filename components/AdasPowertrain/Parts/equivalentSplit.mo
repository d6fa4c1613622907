within AdasPowertrain.Parts;
function equivalentSplit
  "Torque of the engine that minimises fuel power + equivalence * battery power at one instant. The engine's
   Willans line bends upwards, the machine's losses grow by linear and squared torque, the battery's by squared power: the sum is convex, and
   its minimum is where the slope changes its sign (D. Ambuehl, O. Sundstroem, A. Sciarretta, L. Guzzella: Explicit optimal
   control policy and its practical application for hybrid electric powertrains, Control Engineering Practice 18, 2010)"
  input Real shaft_torque(unit = "N.m") "Of engine and machine together";
  input Real speed(unit = "rad/s") "Of both";
  input Real slope "Of the engine's Willans line";
  input Real drag(unit = "N.m") "Of the engine without fuel";
  input Real throttling(unit = "N.m") "Of the engine with a closed throttle";
  input Real natural(unit = "N.m") "Torque of the engine's charge without throttle and boost";
  input Real late_ignition "As in fuelTorque";
  input Real equivalence "Fuel power that one watt out of the battery is worth";
  input Real linear_loss(unit = "W/(N.m)") "Of the machine";
  input Real squared_loss(unit = "W/(N2.m2)") "Of the machine";
  input Real battery_loss(unit = "1/W") "Loss per squared power";
  input Real lowest(unit = "N.m") "Of the engine";
  input Real highest(unit = "N.m") "Of the engine";
  output Real torque(unit = "N.m");
protected
  Real low;
  Real high;
  Real machine;
  Real electric;
  Real charge "Of the engine";
  Real rise "Of the sum with the engine's torque";
algorithm
  low := lowest;
  high := max(lowest, highest);
  for k in 1:30 loop
    torque := 0.5*(low + high);
    machine := shaft_torque - torque;
    electric := machine*speed + linear_loss*abs(machine) + squared_loss*machine*machine;
    charge := Engines.chargeTorque(torque + drag, throttling, natural);
    rise := speed/slope*(if charge < natural then natural/(natural + throttling) else 1)*(1 + 2*late_ignition*max(0, charge/natural - 1))
      - equivalence*(1 + 2*battery_loss*electric)*(speed + linear_loss*(if machine > 0 then 1 else -1)
      + 2*squared_loss*machine);
    if rise > 0 then
      high := torque;
    else
      low := torque;
    end if;
  end for;
  torque := 0.5*(low + high);
end equivalentSplit;
