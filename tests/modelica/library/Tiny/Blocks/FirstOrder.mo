within Tiny.Blocks;
block FirstOrder "First order transfer function block (= 1 pole)"
  type Init = enumeration(NoInit, SteadyState, InitialState, InitialOutput);
  parameter Real k(unit = "1") = 1 "Gain";
  parameter Real T(unit = "s", start = 1) "Time constant";
  parameter Init initType = Init.NoInit annotation(Evaluate = true);
  parameter Real y_start = 0;
  Interfaces.RealInput u;
  Interfaces.RealOutput y(start = y_start);
initial equation
  if initType == Init.SteadyState then
    der(y) = 0;
  elseif initType == Init.InitialState or initType == Init.InitialOutput then
    y = y_start;
  end if;
equation
  der(y) = (k * u - y) / T;
end FirstOrder;
