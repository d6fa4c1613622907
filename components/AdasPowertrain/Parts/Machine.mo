within AdasPowertrain.Parts;
model Machine
  "Synchronous machine of 85 kW with its inverter; the rotor's inertia belongs to the gearbox or axle it drives.
   Volkswagen Golf 8 eHybrid / GTE: 85 kW, 330 N.m (technical data, 2020). Flux, inductance and resistances are those
   of the non-salient equivalent that reaches this envelope at 350 V and a best efficiency of about 96 %."
  extends Machines.Controlled(
    max_torque=330, max_power=85000, torque_lag=0.02, pole_pairs=8, flux_linkage=0.05, inductance=9e-5, stator_resistance=0.010,
    hysteresis_loss=45, eddy_loss=0.012, viscous_friction=4e-4, initial_voltage=350);
  Interfaces.RealOutput energy_in(unit="J", start=0, fixed=true) "From the link, since the start";
  Interfaces.RealOutput energy_out(unit="J", start=0, fixed=true) "To the shaft, since the start";
  Interfaces.RealOutput energy_loss(unit="J", start=0, fixed=true) "Turned into heat, since the start";
equation
  der(energy_in) = electric_power;
  der(energy_out) = torque * shaft_speed;
  der(energy_loss) = loss;
end Machine;
