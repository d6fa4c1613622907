package Axle "Differentials and half shafts between inertias, compared with closed forms and scipy"
  import AdasPowertrain.Driveline;
  import AdasPowertrain.Interfaces;

  partial model Bench "A driven inertia, a differential, half shafts, and a wheel at the end of each"
    parameter Real wheel_inertia = 1;
    Driveline.Inertia engine(inertia = 0.2);
    Driveline.HalfShafts shafts(speed_left = left_speed, speed_right = right_speed);
    Interfaces.RealInput torque(start = 0);
    Interfaces.RealInput load_left(start = 0);
    Interfaces.RealInput load_right(start = 0);
    Driveline.TorqueSource source(torque = torque);
    output Real left_speed(start = 0, fixed = true);
    output Real right_speed(start = 0, fixed = true);
    output Real work(start = 0, fixed = true) "Of the source, less that of the loads";
    output Real loss(start = 0, fixed = true);
    output Real energy;
  protected
    Real loss_power;
    Real angle(start = 0, fixed = true);
  equation
    angle = engine.a.phi;
    connect(source.flange, engine.a);
    wheel_inertia*der(left_speed) = shafts.torque_left - load_left;
    wheel_inertia*der(right_speed) = shafts.torque_right - load_right;
    der(work) = torque*engine.speed - load_left*left_speed - load_right*right_speed;
    der(loss) = loss_power;
    energy = engine.energy + shafts.energy + 0.5*wheel_inertia*(left_speed^2 + right_speed^2);
  end Bench;

  model Open
    extends Bench;
    Driveline.OpenDifferential differential(ratio = 15);
    output Real difference = shafts.torque_left - shafts.torque_right;
  equation
    connect(engine.b, differential.a);
    connect(differential.left, shafts.a);
    connect(differential.right, shafts.b);
    loss_power = shafts.loss_power;
  end Open;

  model LimitedSlip
    extends Bench;
    Driveline.LimitedSlipDifferential differential(ratio = 15);
    output Real slip = differential.slip;
    output Real moved = differential.moved;
    output Real whole_energy = energy + differential.energy;
    output Integer mode = differential.plates.mode;
  equation
    connect(engine.b, differential.a);
    connect(differential.left, shafts.a);
    connect(differential.right, shafts.b);
    loss_power = shafts.loss_power + differential.loss_power;
  end LimitedSlip;
end Axle;
