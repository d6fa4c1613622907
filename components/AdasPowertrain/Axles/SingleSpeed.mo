within AdasPowertrain.Axles;
model SingleSpeed
  "Fixed reduction, differential and half shafts with stiffness and damping, between a machine's shaft and the wheels'
   speeds. The wheels' inertia belongs to the car. If signals are exchanged every h seconds and the tyres slip, so
   that only the wheels' inertia J is left, the exchange is stable for a < b (1 - b), with a = stiffness h^2 / J and b
   = damping h / J. The defaults are that soft (half shafts, tyre walls and mounts in series) for J = 2 kg.m2 of an
   axle and h = 10 ms."
  parameter Real ratio(min=0.5, max=30) = 11.53 "Speed of the machine over that of the wheels";
  parameter Real stiffness(unit="N.m/rad", min=100, max=1e5) = 3000 "Of both half shafts and tyres together";
  parameter Real damping(unit="N.m.s/rad", min=0, max=1e4) = 100 "Of both half shafts and tyres together";
  parameter Real loss_share(min=0, max=0.3) = 0.02 "Torque lost in the gears over torque transmitted";
  parameter Real viscous_friction(unit="N.m.s/rad", min=0) = 1.5e-3 "Of oil and bearings, machine side";
  parameter Real front_share(min=0, max=1) = 0 "1 drives the front axle, 0 the rear, between them both through a differential";
  Interfaces.RotationalFlange flange "The machine's shaft";
  Interfaces.RealInput wheel_speed_front(unit="rad/s");
  Interfaces.RealInput wheel_speed_rear(unit="rad/s");
  Interfaces.RealOutput torque_front(unit="N.m");
  Interfaces.RealOutput torque_rear(unit="N.m");
  output Real loss(unit="W") "Of gears and half shafts";
  output Real elastic_energy(unit="J");
  output Real wheel_speed(unit="rad/s") "Of the driven wheels";
  MeshLoss mesh(loss_share=loss_share, viscous_friction=viscous_friction);
protected
  Real twist(unit="rad", start=0, fixed=true) "Of the half shafts";
  Real twist_speed(unit="rad/s");
  Real torque(unit="N.m") "Of the half shafts";
equation
  wheel_speed = front_share * wheel_speed_front + (1 - front_share) * wheel_speed_rear;
  mesh.speed = der(flange.phi);
  twist_speed = mesh.speed / ratio - wheel_speed;
  der(twist) = twist_speed;
  torque = stiffness * twist + damping * twist_speed;
  mesh.torque = torque / ratio;
  flange.tau = mesh.torque + mesh.loss_torque;
  torque_front = front_share * torque;
  torque_rear = (1 - front_share) * torque;
  loss = mesh.loss + damping * twist_speed ^ 2;
  elastic_energy = 0.5 * stiffness * twist ^ 2;
end SingleSpeed;
