within AdasPowertrain.Parts;
model Engine15 "Four-cylinder petrol engine, 1.5 l, 110 kW"
  extends Engine(data = petrol);
  parameter Vehicles.TurboPetrol15 petrol(auxiliary_power = 0) "Without an alternator: the traction battery feeds the vehicle";
end Engine15;
