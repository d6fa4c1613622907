within AdasPowertrain.Parts;
model SingleSpeedAxle
  "Rotor, fixed reduction and half shafts of a driven axle. Defaults: BMW i3: ratio 9.665, rear axle (technical data,
   2013)."
  parameter Real ratio(min=2, max=20) = 9.665 "Speed of the machine over that of the wheels";
  parameter Real rotor_inertia(unit="kg.m2", min=0.005, max=0.3) = 0.05 "Of the machine, with the first gear";
  parameter Real stiffness(unit="N.m/rad", min=500, max=50000) = 3000 "Of both half shafts and tyres together";
  parameter Real damping(unit="N.m.s/rad", min=10, max=1000) = 100 "Of both half shafts and tyres together";
  parameter Real front_share(min=0, max=1) = 0 "1 drives the front axle, 0 the rear, between them both through a differential";
  Interfaces.RealInput machine_torque(unit="N.m", start=0);
  Interfaces.RealInput wheel_speed_front(unit="rad/s", start=0);
  Interfaces.RealInput wheel_speed_rear(unit="rad/s", start=0);
  Interfaces.RealOutput machine_speed(unit="rad/s");
  Interfaces.RealOutput torque_front(unit="N.m");
  Interfaces.RealOutput torque_rear(unit="N.m");
  Interfaces.RealOutput energy_in(unit="J", start=0, fixed=true) "From the machine, since the start";
  Interfaces.RealOutput energy_out(unit="J", start=0, fixed=true) "To the wheels, since the start";
  Interfaces.RealOutput energy_loss(unit="J", start=0, fixed=true) "Turned into heat, since the start";
  Interfaces.RealOutput energy_stored(unit="J") "In rotor and half shafts, now";
  Axles.SingleSpeed axle(ratio=ratio, stiffness=stiffness, damping=damping, front_share=front_share);
  Axles.Rotor rotor(inertia=rotor_inertia);
initial equation
  machine_speed = ratio * axle.wheel_speed;
equation
  connect(rotor.flange, axle.flange);
  rotor.torque = machine_torque;
  machine_speed = rotor.speed;
  axle.wheel_speed_front = wheel_speed_front;
  axle.wheel_speed_rear = wheel_speed_rear;
  torque_front = axle.torque_front;
  torque_rear = axle.torque_rear;
  der(energy_in) = machine_torque * machine_speed;
  der(energy_out) = torque_front * wheel_speed_front + torque_rear * wheel_speed_rear;
  der(energy_loss) = axle.loss;
  energy_stored = rotor.kinetic_energy + axle.elastic_energy;
end SingleSpeedAxle;
