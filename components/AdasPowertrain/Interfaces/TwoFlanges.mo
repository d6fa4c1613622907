within AdasPowertrain.Interfaces;
partial model TwoFlanges "Something with two ends of a shaft"
  RotationalFlange a "Towards the engine";
  RotationalFlange b "Towards the wheels";
end TwoFlanges;
