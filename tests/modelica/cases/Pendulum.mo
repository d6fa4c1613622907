// A pendulum in Cartesian coordinates: index 3 with a nonlinear constraint; the state is told by stateSelect.
model Pendulum
  parameter Real L = 1;
  parameter Real g = 9.81;
  Real x(start = 0.6, fixed = true, stateSelect = StateSelect.always);
  Real vx(start = 0, fixed = true, stateSelect = StateSelect.always);
  Real y(start = -0.8);
  Real vy;
  Real F(start = 5);
  output Real height;
  output Real tension;
equation
  der(x) = vx;
  der(y) = vy;
  der(vx) = -F * x / L;
  der(vy) = -F * y / L - g;
  x ^ 2 + y ^ 2 = L ^ 2;
  height = y;
  tension = F;
end Pendulum;
