within AdasPowertrain.Vehicles;
record TurboPetrol10
  "Volkswagen 1.0 TSI (EA211): 999 cm3, 200 N.m from 2000 to 3500/min, 85 kW from 5000 to 5500/min (Volkswagen's data
   sheet of the Golf). Between and outside these points, the slopes of the Willans lines, inertia, lag and auxiliary
   power: ours, usual for the class"
  extends EngineData(
    displacement = 0.999e-3,
    inertia = 0.12,
    idle_speed = 92,
    max_power = 85e3,
    speeds = {0, 42, 105, 209.4, 366.5, 523.6, 576, 649, 691},
    full_load = {-8, 0, 100, 200, 200, 162.3, 147.6, 115, -35},
    efficiency = {0.333, 0.343, 0.372, 0.387, 0.392, 0.372, 0.363, 0.343, 0.333},
    auxiliary_power = 450,
    air_lag = 0.14);
end TurboPetrol10;
