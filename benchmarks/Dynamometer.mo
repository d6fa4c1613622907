package Dynamometer "Cars on a chassis dynamometer: road load by three coefficients, inertia by the equivalent test weight"
  partial model Car
    parameter Real mass(unit = "kg") = 1531;
    parameter Real radius(unit = "m") = 0.31;
    parameter Real f0(unit = "N") = 117 "Target coefficient A";
    parameter Real f1(unit = "N.s/m") = 1.6 "Target coefficient B";
    parameter Real f2(unit = "N.s2/m2") = 0.38 "Target coefficient C";
    parameter Real gain(unit = "N.m.s/m") = 2000 "Of the driver";
    replaceable AdasPowertrain.Interfaces.Powertrain powertrain;
    input Real target(unit = "m/s", start = 0);
    input Real acceleration(unit = "m/s2", start = 0) "Of the target";
    output Real speed(unit = "m/s", start = 0, fixed = true);
    output Real distance(unit = "m", start = 0, fixed = true);
    output Real carbon_dioxide(unit = "kg", start = 0, fixed = true);
  protected
    Real resistance(unit = "N");
    Real wanted(unit = "N.m");
  equation
    resistance = (f0 + f1*speed + f2*speed*abs(speed))*tanh(speed/0.1);
    wanted = (mass*acceleration + resistance)*radius + gain*(target - speed);
    powertrain.torque_demand = max(0, wanted);
    powertrain.wheel_speed_front = speed/radius;
    powertrain.wheel_speed_rear = speed/radius;
    mass*der(speed) = (powertrain.torque_front + powertrain.torque_rear - max(0, -wanted)*tanh(speed/0.1))/radius - resistance;
    der(distance) = speed;
    der(carbon_dioxide) = powertrain.co2;
  end Car;

  model Automatic
    extends Car(redeclare AdasPowertrain.Powertrains.CombustionAutomatic powertrain(has_slip_control = true, is_cold = true));
  end Automatic;

  model DualClutch
    extends Car(redeclare AdasPowertrain.Powertrains.CombustionDualClutch powertrain(is_cold = true));
  end DualClutch;
end Dynamometer;
