// Two inertias coupled rigidly by a gear: index 2, one state is removed.
model RigidGear
  parameter Real J1 = 2;
  parameter Real J2 = 3;
  parameter Real ratio = 4;
  Real phi1(start = 0, stateSelect = StateSelect.avoid);
  Real phi2(start = 0.5, fixed = true);
  Real w1;
  Real w2(start = 1, fixed = true);
  Real tau1;
  Real tau2;
  input Real u(start = 10);
  output Real speed;
  output Real load;
equation
  der(phi1) = w1;
  der(phi2) = w2;
  J1 * der(w1) = u - tau1;
  J2 * der(w2) = tau2 - 0.5 * w2;
  phi1 = ratio * phi2;
  ratio * tau1 = tau2;
  speed = w1;
  load = tau2;
end RigidGear;
