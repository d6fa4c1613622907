within Tiny.Interfaces;
connector Flange_a "One end of a shaft"
  Units.Angle phi "Absolute rotation angle of flange";
  flow Units.Torque tau "Cut torque in the flange";
end Flange_a;
