within AdasPowertrain.Generators;
block GeneratorMachine "Generator with rectifier: losses by torque and speed"
  parameter Real copper_loss(unit="W/(N2.m2)", min=0) = 0.25 "Per torque squared, rectifier counted in";
  parameter Real iron_loss(unit="W.s2/rad2", min=0) = 0.0025 "Per speed squared";
  input Real torque(unit="N.m") "Taken from the shaft";
  input Real speed(unit="rad/s");
  output Real electric_power(unit="W") "Given";
  output Real loss(unit="W");
equation
  loss = copper_loss * torque ^ 2 + iron_loss * speed ^ 2;
  electric_power = torque * speed - loss;
end GeneratorMachine;
