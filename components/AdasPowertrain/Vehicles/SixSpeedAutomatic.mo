within AdasPowertrain.Vehicles;
record SixSpeedAutomatic
  "Ratios of Aisin AW TF-60SN (Volkswagen 09G), a transverse six-speed automatic: 4.148, 2.370, 1.556, 1.155, 0.859,
   0.686. Final ratio, losses, inertias and shift speeds: ours, usual for the class"
  extends GearboxData(
    gears = 6,
    ratios = {4.148, 2.370, 1.556, 1.155, 0.859, 0.686},
    final_ratio = 3.5,
    efficiency = 0.97,
    drag = 2,
    inertia_in = 0.06,
    inertia_out = 0.03,
    shift_time = 0.4,
    dwell = 0.6,
    up_calm = 210,
    up_full = 600,
    down_calm = 110,
    down_full = 320);
end SixSpeedAutomatic;
