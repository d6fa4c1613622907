model DriveTrain "A speed control of two inertias on a compliant shaft with a gear whose housing is fixed"
  parameter Real wanted = 5;
  Tiny.Blocks.Step step(height = wanted, startTime = 0.25);
  Tiny.Blocks.Feedback feedback;
  Tiny.Blocks.PI controller(k = 8, T = 0.4);
  Tiny.Blocks.FirstOrder actuator(T = 0.05, initType = Tiny.Blocks.FirstOrder.Init.InitialOutput);
  Tiny.Rotational.Torque torque;
  Tiny.Rotational.Inertia motor(J = 0.5, phi(start = 0, fixed = true), w(start = 0, fixed = true));
  Tiny.Rotational.IdealGear gear(ratio = 3, useSupport = true);
  Tiny.Rotational.Fixed housing;
  Tiny.Rotational.SpringDamper shaft(c = 80, d = 2, phi_rel(start = 0, fixed = true));
  Tiny.Rotational.Inertia load(J = 4, w(start = 0, fixed = true));
  Tiny.Rotational.SpeedSensor sensor;
  output Real speed = load.w;
  output Real reaction = housing.flange.tau;
equation
  connect(step.y, feedback.u1);
  connect(sensor.w, feedback.u2);
  connect(feedback.y, controller.u);
  connect(controller.y, actuator.u);
  connect(actuator.y, torque.tau);
  connect(torque.flange, motor.flange_a);
  connect(motor.flange_b, gear.flange_a);
  connect(gear.support, housing.flange);
  connect(gear.flange_b, shaft.flange_a);
  connect(shaft.flange_b, load.flange_a);
  connect(load.flange_b, sensor.flange);
end DriveTrain;
