within AdasPowertrain.Parts;
model Machine60kW
  "Synchronous machine of 60 kW with its inverter; the rotor's inertia belongs to the gearbox or axle it drives.
   Traction machine of the Toyota Prius of 2010: 60 kW, 207 N.m, 13,500 rev/min, four pairs of poles (Burress et al.,
   Evaluation of the 2010 Toyota Prius hybrid synergy drive system, ORNL/TM-2010/253). Flux, inductance and
   resistances are those of the non-salient equivalent that reaches this envelope at 350 V and a best efficiency of
   about 95 %."
  extends Machine(
    max_torque=207, max_power=60000, torque_lag=0.02, pole_pairs=4, flux_linkage=0.12, inductance=4e-4, stator_resistance=0.025,
    hysteresis_loss=20, eddy_loss=0.008, viscous_friction=3e-4, initial_voltage=350);
end Machine60kW;
