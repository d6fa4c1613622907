within AdasPowertrain.Axles;
block MeshLoss
  "Torque that a gear train loses, on its fast side. A share of the torque that is transmitted, whichever way the
   power flows, and a viscous part of oil and bearings (Naunheimer et al.: Automotive Transmissions, 2011, ch. 3.1.5).
   Never gives energy back."
  parameter Real loss_share(min=0, max=0.3) = 0.02 "Of the torque transmitted";
  parameter Real viscous_friction(unit="N.m.s/rad", min=0) = 1.5e-3 "Of oil and bearings, fast side";
  input Real torque(unit="N.m") "Transmitted, fast side";
  input Real speed(unit="rad/s") "Of the fast side";
  output Real loss_torque(unit="N.m") "Acts against the speed";
  output Real loss(unit="W");
protected
  constant Real torque_scale(unit="N.m") = 1 "Below it the loss no longer falls with the torque";
  constant Real speed_scale(unit="rad/s") = 5 "Below it the loss fades out";
equation
  loss_torque = loss_share * sqrt(torque ^ 2 + torque_scale ^ 2) * speed / sqrt(speed ^ 2 + speed_scale ^ 2) + viscous_friction * speed;
  loss = loss_torque * speed;
end MeshLoss;
