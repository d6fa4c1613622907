within AdasPowertrain.Interfaces;
partial model ThreeFlanges "Something that divides a shaft in two"
  RotationalFlange a "Towards the engine";
  RotationalFlange left "Towards the left wheel";
  RotationalFlange right "Towards the right wheel";
end ThreeFlanges;
