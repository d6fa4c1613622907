within AdasPowertrain.Machines;
block SteadyState
  "Currents and losses of a synchronous machine in its rotating frame, electrical transients settled. Non-salient
   equivalent: torque = 1.5 pole_pairs flux_linkage i_q. Below the corner i_d = 0; above it i_d < 0 keeps the flux
   small enough for the voltage (ohmic drop neglected in the limit, not in the losses). Copper, iron and friction
   losses as in Pillay and Krishnan, IEEE Trans. Ind. Appl. 25 (1989), and Morimoto et al., IEEE Trans. Ind. Appl. 30
   (1994)."
  parameter Integer pole_pairs(min=1) = 4 "Pairs of poles";
  parameter Real flux_linkage(unit="Wb", min=1e-4) = 0.08 "Of the magnets in a phase, amplitude; reluctance torque counted in";
  parameter Real inductance(unit="H", min=1e-7) = 1.2e-4 "Of a phase, the same along both axes";
  parameter Real stator_resistance(unit="Ohm", min=0) = 0.008 "Of a phase, warm";
  parameter Real hysteresis_loss(min=0) = 100 "Iron loss per flux squared and electrical speed, W.s/(Wb2.rad)";
  parameter Real eddy_loss(min=0) = 0.03 "Iron loss per flux squared and electrical speed squared, W.s2/(Wb2.rad2)";
  parameter Real viscous_friction(unit="N.m.s/rad", min=0) = 2e-4 "Of bearings and air";
  parameter Real modulation(min=0.1, max=1.1) = 0.95 "Largest phase voltage over its limit, link voltage / sqrt(3)";
  input Real torque(unit="N.m") "On the shaft";
  input Real speed(unit="rad/s") "Of the shaft";
  input Real link_voltage(unit="V") "Between the poles of the direct-current link";
  output Real current_squared(unit="A2") "Amplitude of a phase current, squared";
  output Real copper_loss(unit="W");
  output Real iron_loss(unit="W");
  output Real friction_loss(unit="W");
  output Real available_power(unit="W") "Most power that the voltage allows at any speed";
  output Boolean is_weakened(start=false) "Whether the field is weakened";
protected
  Real electrical_speed(unit="rad/s");
  Real voltage(unit="V") "Largest amplitude of a phase";
  Real quadrature_current(unit="A");
  Real direct_current(unit="A");
  Real quadrature_flux(unit="Wb");
  Real free_flux_squared(unit="Wb2") "Without weakening";
  Real flux_squared(unit="Wb2");
equation
  electrical_speed = pole_pairs * speed;
  voltage = modulation * link_voltage / sqrt(3);
  quadrature_current = torque / (1.5 * pole_pairs * flux_linkage);
  quadrature_flux = inductance * quadrature_current;
  free_flux_squared = flux_linkage ^ 2 + quadrature_flux ^ 2;
  is_weakened = electrical_speed ^ 2 * free_flux_squared > voltage ^ 2;
  flux_squared = if is_weakened then voltage ^ 2 / electrical_speed ^ 2 else free_flux_squared;
  direct_current = if is_weakened then (sqrt(noEvent(max(flux_squared - quadrature_flux ^ 2, 0))) - flux_linkage) / inductance else 0;
  current_squared = direct_current ^ 2 + quadrature_current ^ 2;
  copper_loss = 1.5 * stator_resistance * current_squared;
  /* |x| is written x2 / sqrt(x2 + 1): smooth, and zero at rest. */
  iron_loss = flux_squared * electrical_speed ^ 2 * (hysteresis_loss / sqrt(electrical_speed ^ 2 + 1) + eddy_loss);
  friction_loss = viscous_friction * speed ^ 2;
  available_power = 1.5 * voltage * flux_linkage / inductance;
end SteadyState;
