within AdasPowertrain.Gearboxes;
model DualClutch
  "Dual-clutch gearbox: the clutch that drives off closes with the engine's speed; shifts are those of the stepped gear,
   in which one clutch slips while the other has opened"
  extends Interfaces.TwoFlanges;
  parameter Vehicles.GearboxData data;
  parameter Real initial_speed(unit = "rad/s", min = 0) = 0 "Of the output";
  parameter Real initial_slip(unit = "rad/s") = 0 "Engine speed beyond the input's";
  parameter Real max_power(unit = "W") "Full load, for the shift schedule";
  parameter Real clutch_capacity(unit = "N.m") = 400 "Closed";
  parameter Real bite_speed(unit = "rad/s") = 69
    "Engine speed from which the clutch closes; below idle, so that the car creeps";
  parameter Real closed_speed(unit = "rad/s") = 170 "Engine speed at which the clutch holds 250 N.m";
  parameter Real intervention_share(min = 0, max = 1) = 0 "Part of the torque that slows the engine in upshifts which its ignition takes over";
  parameter Real engine_inertia(unit = "kg.m2", min = 0) = 0 "For the intervention";
  Interfaces.RealInput wheel_speed(unit = "rad/s") "Driven axle";
  Interfaces.RealInput power_demand(unit = "W");
  Real ratio "Torque at the output against torque at the input, before losses";
  Real intervention(unit = "N.m") "Torque that the engine is to give less";
  Real loss_power(unit = "W");
  Real energy(unit = "J") "Kinetic";
  Couplings.Clutch clutch(
    capacity = capacity,
    initial_mode = if starts_locked then 0 elseif initial_slip < 0 then -1 else 1);
  SteppedGear gear(
    data = data,
    initial_speed = initial_speed,
    max_power = max_power,
    wheel_speed = wheel_speed,
    power_demand = power_demand);
  final parameter Real initial_input_speed(unit = "rad/s") = initial_speed*data.ratios[gear.schedule.initial_gear];
  parameter Boolean starts_locked = false "The engine starts at the input's speed";
protected
  constant Real at_closed(unit = "N.m") = 250;
  Real engine_speed(unit = "rad/s");
  Real beyond "Engine speed beyond the bite, 1 at the closed speed";
  Real capacity(unit = "N.m");
equation
  connect(a, clutch.a);
  connect(clutch.b, gear.a);
  connect(gear.b, b);
  engine_speed = der(a.phi);
  beyond = max(0, engine_speed - bite_speed)/(closed_speed - bite_speed);
  capacity = max(0, Smooth.minimum(clutch_capacity, at_closed*beyond*beyond, 1));
  intervention = intervention_share*(engine_inertia + data.inertia_in)*noEvent(max(0, -gear.schedule.ratio_rate*gear.output_speed));
  ratio = gear.schedule.ratio;
  loss_power = clutch.loss_power + gear.loss_power;
  energy = gear.energy;
end DualClutch;
