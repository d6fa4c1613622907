within AdasPowertrain.Interfaces;
connector RotationalFlange "End of a shaft"
  Real phi(unit="rad") "Angle";
  flow Real tau(unit="N.m") "Torque into the component";
end RotationalFlange;
