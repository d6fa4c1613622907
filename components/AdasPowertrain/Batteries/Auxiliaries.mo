within AdasPowertrain.Batteries;
model Auxiliaries "What light, cooling and control units take from the link, constantly"
  parameter Real power(unit="W", min=0, max=10000) = 350;
  Interfaces.DcLink link;
equation
  link.p = power;
end Auxiliaries;
