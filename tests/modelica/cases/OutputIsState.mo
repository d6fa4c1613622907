// The output itself is the state, and an input is used only through an alias in a component.
model OutputIsState
  block Lag
    input Real u;
    output Real y(start = 1, fixed = true);
  equation
    der(y) = u - y;
  end Lag;
  input Real u(start = 0.5);
  output Real y(start = 2, fixed = true);
  Lag lag;
equation
  lag.u = u;
  der(y) = lag.y;
end OutputIsState;
