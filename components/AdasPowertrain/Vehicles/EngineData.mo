within AdasPowertrain.Vehicles;
record EngineData
  "A petrol engine by Willans lines: brake torque = efficiency * fuel power / speed - friction torque
   (L. Guzzella, A. Sciarretta: Vehicle Propulsion Systems, Springer, chapter on engine models).
   Friction: motored total of four-cylinder engines of 0.8 to 2 l, 0.97 + 0.15 n + 0.05 n2 bar with n in 1000/min
   (J. B. Heywood: Internal Combustion Engine Fundamentals, McGraw-Hill 1988, section 13.6)"
  parameter Real displacement(unit = "m3");
  parameter Real inertia(unit = "kg.m2") "With flywheel or flexplate";
  parameter Real idle_speed(unit = "rad/s");
  parameter Real max_power(unit = "W");
  parameter Real speeds[9](each unit = "rad/s") "For the two tables";
  parameter Real full_load[9](each unit = "N.m") "Brake torque; ends at the friction torque where nothing burns";
  parameter Real efficiency[9] "Slope of the Willans line";
  parameter Real friction_pressure(unit = "Pa") = 0.97e5 "Mean, at rest";
  parameter Real friction_pressure_1(unit = "Pa.s/rad") = 143.24 "Growing with the speed";
  parameter Real friction_pressure_2(unit = "Pa.s2/rad2") = 0.45595 "Growing with the squared speed";
  parameter Real natural_pressure(unit = "Pa") = 13e5 "Mean effective pressure of the combustion without boost";
  parameter Real auxiliary_power(unit = "W") "For the alternator and pumps, while running";
  parameter Real air_lag(unit = "s") "Time constant of the manifold and the charger";
end EngineData;
