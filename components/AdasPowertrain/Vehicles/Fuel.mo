within AdasPowertrain.Vehicles;
record Fuel
  "Petrol: JEC Well-to-Tank report v5 (JRC, 2020), lower heating value 43.2 MJ/kg, 73.4 g CO2 per MJ burned"
  parameter Real heating_value(unit = "J/kg") = 43.2e6 "Lower";
  parameter Real air_per_fuel = 14.6 "Masses, stoichiometric";
  parameter Real co2_per_energy(unit = "kg/J") = 73.4e-9 "Tank to wheel";
end Fuel;
