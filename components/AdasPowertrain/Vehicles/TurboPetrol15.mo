within AdasPowertrain.Vehicles;
record TurboPetrol15
  "Volkswagen 1.5 TSI evo (EA211): 1498 cm3, 250 N.m from 1500 to 3500/min, 110 kW from 5000 to 6000/min
   (Volkswagen's data sheet of the Golf). Between and outside these points, the slopes of the Willans lines (best brake
   efficiency near 0.37), inertia, lag and auxiliary power: ours, usual for the class"
  extends EngineData(
    displacement = 1.498e-3,
    inertia = 0.15,
    idle_speed = 90,
    max_power = 110e3,
    speeds = {0, 42, 105, 157, 366.5, 523.6, 628.3, 670, 712},
    full_load = {-12, 0, 135, 250, 250, 210.1, 175.1, 140, -50},
    efficiency = {0.333, 0.343, 0.377, 0.392, 0.397, 0.377, 0.353, 0.343, 0.333},
    auxiliary_power = 500,
    air_lag = 0.12);
end TurboPetrol15;
