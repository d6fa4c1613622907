within AdasPowertrain.Vehicles;
record SevenSpeedDualClutch
  "Ratios of Volkswagen's DQ200 (0AM), a dry dual-clutch gearbox with two output shafts: gears 3.765, 2.273, 1.531,
   1.122 with the final ratio 4.438 and 1.176, 0.951, 0.795 with 3.227; here all refer to 4.438. Losses, inertias and
   shift speeds: ours, usual for the class"
  extends GearboxData(
    gears = 7,
    ratios = {3.765, 2.273, 1.531, 1.122, 0.8551, 0.6915, 0.5781},
    final_ratio = 4.438,
    efficiency = 0.975,
    drag = 1,
    inertia_in = 0.02,
    inertia_out = 0.02,
    shift_time = 0.25,
    dwell = 0.5,
    up_calm = 200,
    up_full = 600,
    down_calm = 105,
    down_full = 320);
end SevenSpeedDualClutch;
