within AdasPowertrain.Parts;
model GeneratorSet
  "Range extender: two-cylinder petrol engine and generator, led along a line of good efficiency. BMW i3 REx: 647 cm3,
   two cylinders, 25 kW and 55 N.m at 4300 rev/min (BMW of North America, technical data, 2014). The generator leads
   the speed, the engine gives the power; starting and stopping draw on the battery and give back what the shaft
   stores. Efficiencies and inertia are chosen: about 32 % from fuel to cables at best."
  parameter Real max_power(unit="W", min=1000, max=100000) = 23000 "Electric";
  parameter Real least_power(unit="W", min=100, max=50000) = 3000 "Below it the engine stops";
  parameter Real inertia(unit="kg.m2", min=0.005, max=1) = 0.08 "Of crankshaft, flywheel and generator";
  parameter Real speed_lag(unit="s", min=0.05, max=5) = 0.4 "Of the speed behind its line";
  parameter Real assumed_efficiency(min=0.3, max=1) = 0.94 "Of the generator, for the engine's torque";
  parameter Real firing_speed(unit="rad/s", min=10, max=300) = 80 "From here fuel is given";
  parameter Real line_power[5](each unit="W") = {0, 5000, 10000, 16000, 23000} "Electric power of the points of the line";
  parameter Real line_speed[5](each unit="rad/s") = {160, 180, 250, 350, 450} "Speed there";
  Interfaces.RealInput power_demand(unit="W", start=0) "Electric";
  Interfaces.RealOutput electric_power(unit="W") "Fed to the cables; negative while starting";
  Interfaces.RealOutput fuel_power(unit="W") "Lower heating value";
  Interfaces.RealOutput co2(unit="kg/s") "Out of the exhaust";
  Interfaces.RealOutput speed(unit="rad/s", start=0, fixed=true) "Of the crankshaft";
  output Boolean is_running(start=false, fixed=true) "Whether power is wanted";
  Interfaces.RealOutput energy_in(unit="J", start=0, fixed=true) "Fuel, since the start";
  Interfaces.RealOutput energy_out(unit="J", start=0, fixed=true) "To the cables, since the start";
  Interfaces.RealOutput energy_loss(unit="J", start=0, fixed=true) "Turned into heat, since the start";
  Interfaces.RealOutput energy_stored(unit="J") "Kinetic, now";
  Generators.WillansEngine engine;
  Generators.GeneratorMachine generator;
protected
  Real wanted(unit="W");
  Real target_speed(unit="rad/s");
  Boolean is_turning(start=false) "Fast enough for fuel";
equation
  is_running = power_demand > least_power or pre(is_running) and power_demand > 0.8 * least_power;
  is_turning = speed > firing_speed;
  wanted = noEvent(max(0, min(power_demand, max_power)));
  target_speed = if is_running then Tables.linear1D(wanted, line_power, line_speed, Tables.Extrapolation.hold) else 0;
  der(speed) = (target_speed - speed) / speed_lag;
  engine.is_firing = is_running and is_turning;
  engine.speed = speed;
  engine.torque_demand = wanted / assumed_efficiency / noEvent(max(speed, firing_speed));
  /* What the engine gives beyond the shaft's acceleration goes to the generator. */
  generator.torque = engine.torque - inertia * der(speed);
  generator.speed = speed;
  electric_power = generator.electric_power;
  fuel_power = engine.fuel_power;
  co2 = engine.co2;
  der(energy_in) = fuel_power;
  der(energy_out) = electric_power;
  der(energy_loss) = engine.loss + generator.loss;
  energy_stored = 0.5 * inertia * speed ^ 2;
end GeneratorSet;
