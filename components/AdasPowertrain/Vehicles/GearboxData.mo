within AdasPowertrain.Vehicles;
record GearboxData "Ratios of a stepped gearbox, its losses and when it shifts"
  parameter Integer gears(min = 1);
  parameter Real ratios[gears] "Input against output speed, falling";
  parameter Real final_ratio;
  parameter Real efficiency "Of the meshes, per torque";
  parameter Real drag(unit = "N.m") "At the input";
  parameter Real inertia_in(unit = "kg.m2") "What turns with the input";
  parameter Real inertia_out(unit = "kg.m2") "What turns with the output";
  parameter Real shift_time(unit = "s") "Of both phases";
  parameter Real torque_phase(unit = "s", min = 0) = 0.0 "Part of it in which the torque is handed over; 0: at once";
  parameter Real dwell(unit = "s") "Least time between two shifts beyond that";
  parameter Real up_calm(unit = "rad/s") "Input speed of an upshift at no load";
  parameter Real up_full(unit = "rad/s") "Input speed of an upshift at full load";
  parameter Real down_calm(unit = "rad/s") "Input speed of a downshift at no load";
  parameter Real down_full(unit = "rad/s") "Input speed of a downshift at full load";
end GearboxData;
