// Three inertias on two rigid gears with a spring to the fourth: index reduction leaves one state of three.
model ThreeInertias
  parameter Real J[3] = {1, 2, 3};
  parameter Real r[2] = {2, -0.5};
  parameter Real c = 50;
  Real phi[3];
  Real w[3];
  Real a[3];
  Real tau[4];
  Real end_angle(start = 0.1, fixed = true);
  Real end_speed(start = 0, fixed = true);
  output Real y;
  output Real z;
initial equation
  phi[1] = 0;
  w[1] = 1;
equation
  for i in 1:3 loop
    der(phi[i]) = w[i];
    der(w[i]) = a[i];
  end for;
  phi[1] = r[1] * phi[2];
  phi[2] = r[2] * phi[3];
  J[1] * a[1] = tau[1];
  J[2] * a[2] = -r[1] * tau[1] + tau[2];
  J[3] * a[3] = -r[2] * tau[2] + tau[3];
  tau[3] = c * (end_angle - phi[3]);
  tau[4] = tau[3];
  der(end_angle) = end_speed;
  0.5 * der(end_speed) = -tau[4];
  y = w[1];
  z = end_angle;
end ThreeInertias;
