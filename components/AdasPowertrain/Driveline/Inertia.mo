within AdasPowertrain.Driveline;
model Inertia "Turning mass"
  extends Interfaces.TwoFlanges;
  parameter Real inertia(unit = "kg.m2", min = 0);
  parameter Real initial_speed(unit = "rad/s") = 0;
  Real speed(unit = "rad/s", start = initial_speed, fixed = true, stateSelect = StateSelect.prefer);
  Real energy(unit = "J") "Kinetic";
equation
  a.phi = b.phi;
  speed = der(a.phi);
  inertia*der(speed) = a.tau + b.tau;
  energy = 0.5*inertia*speed*speed;
end Inertia;
