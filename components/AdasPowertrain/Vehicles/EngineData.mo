within AdasPowertrain.Vehicles;
record EngineData
  "A petrol engine by Willans lines: torque of the charge = efficiency * fuel power / speed, of which friction and throttling
   take their part (L. Guzzella, C. Onder: Introduction to Modeling and Control of Internal Combustion Engine Systems, 2010,
   section 2.5). Friction of the warm engine with oil and water pump, without what the gas loads, which lowers the efficiency:
   D. Sandoval, J. B. Heywood: An improved friction model for spark-ignition engines, SAE 2003-01-0725, for bore 74.5, stroke
   85.9, five bearings of 48 by 18, rods of 47.8 by 18 mm, 16 valves with roller finger followers"
  parameter Real displacement(unit = "m3");
  parameter Real inertia(unit = "kg.m2") "With flywheel or flexplate";
  parameter Real idle_speed(unit = "rad/s");
  parameter Real max_power(unit = "W");
  parameter Real speeds[9](each unit = "rad/s") "For the two tables";
  parameter Real full_load[9](each unit = "N.m") "Brake torque; ends at the friction torque where nothing burns";
  parameter Real efficiency[9] "Slope of the Willans line";
  parameter Real friction_pressure(unit = "Pa") = 0.488e5 "Mean, at rest";
  parameter Real friction_pressure_1(unit = "Pa.s/rad") = 103 "Growing with the speed";
  parameter Real friction_pressure_2(unit = "Pa.s2/rad2") = 0.164 "Growing with the squared speed";
  parameter Real natural_pressure(unit = "Pa") = 13e5 "Mean effective pressure of the charge without throttle and boost";
  parameter Real throttling_pressure(unit = "Pa") = 0.965e5
    "Below the air's, of an intake from which nothing enters: that of the residual gas, compressed 10.5 times, after its expansion";
  parameter Real late_ignition = 0.3 "Additional fuel against knocking, for the squared part of the charge beyond natural_pressure";
  parameter Real auxiliary_power(unit = "W") "For the alternator, while running; 0 in hybrids, where the traction battery feeds the vehicle";
  parameter Real air_lag(unit = "s") "Time constant of the manifold and the charger";
end EngineData;
