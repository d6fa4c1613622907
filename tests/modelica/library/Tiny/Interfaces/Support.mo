within Tiny.Interfaces;
connector Support "One end of a shaft"
  Units.Angle phi "Absolute rotation angle of flange";
  flow Units.Torque tau "Cut torque in the flange";
end Support;
