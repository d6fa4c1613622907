// A position given as a function of time: the force follows by differentiating twice, no state is left.
model PrescribedMotion
  parameter Real m = 2;
  Real s;
  Real v;
  Real f;
  output Real force;
  output Real power;
equation
  s = 0.3 * sin(4 * time) + time ^ 2;
  der(s) = v;
  m * der(v) = f;
  force = f;
  power = f * v;
end PrescribedMotion;
