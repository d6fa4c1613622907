// fails: are singular: there are no states that could be selected
// A pendulum whose y has to be a state: at the lowest point, where x passes 0, y does not determine x.
model StatesBecomeSingular
  Real x(start = 0.6);
  output Real y(start = -0.8, fixed = true, stateSelect = StateSelect.always);
  Real vx;
  Real vy(start = 0, fixed = true, stateSelect = StateSelect.always);
  Real F(start = 5);
equation
  der(x) = vx;
  der(y) = vy;
  der(vx) = -F * x;
  der(vy) = -F * y - 9.81;
  x ^ 2 + y ^ 2 = 1;
end StatesBecomeSingular;
