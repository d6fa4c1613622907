within AdasPowertrain.Interfaces;
partial model EnergyBalance "energy_in = energy_out + energy_loss + change of energy_stored, and what is drawn from the stores"
  RealOutput power(unit = "W") "Drawn from fuel (lower heating value) and battery (chemical) together";
  RealOutput fuel_power(unit = "W");
  RealOutput battery_power(unit = "W") "Discharging if > 0";
  RealOutput co2(unit = "kg/s") "From the tank to the wheels";
  RealOutput energy_in(unit = "J", start = 0, fixed = true) "Out of the stores, since the start";
  RealOutput energy_out(unit = "J", start = 0, fixed = true) "To the wheels, since the start";
  RealOutput energy_loss(unit = "J", start = 0, fixed = true) "Turned into heat or used on board, since the start";
  RealOutput energy_stored(unit = "J") "In motion and elastic deformation of parts, now";
protected
  Real wheel_power(unit = "W") "On the wheels";
  Real loss_power(unit = "W");
equation
  power = fuel_power + battery_power;
  der(energy_in) = power;
  der(energy_out) = wheel_power;
  der(energy_loss) = loss_power;
end EnergyBalance;
