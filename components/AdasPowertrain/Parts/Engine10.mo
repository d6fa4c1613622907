within AdasPowertrain.Parts;
model Engine10 "Three-cylinder petrol engine, 1.0 l, 85 kW"
  extends Engine(data = petrol);
  parameter Vehicles.TurboPetrol10 petrol(auxiliary_power = 0) "Without an alternator: the traction battery feeds the vehicle";
end Engine10;
