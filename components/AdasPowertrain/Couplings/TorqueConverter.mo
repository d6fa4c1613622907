within AdasPowertrain.Couplings;
model TorqueConverter
  "Fluid in a steady state, a pump, b turbine. Driving: capacity and torque ratio over the speed ratio, from the
   quadratic curves of A. J. Kotwicki, Dynamic Models for Torque Converter Equipped Vehicles, SAE 820393 (1982), those
   of the fluid coupling from the speed ratio 0.9 on. Overrun: the coupling with pump and turbine exchanged (ours)"
  extends Interfaces.TwoFlanges;
  parameter Real scale(min = 0) = 1 "Capacity against the published converter; grows with its diameter's 5th power";
  Real pump_speed(unit = "rad/s");
  Real turbine_speed(unit = "rad/s");
  Real speed_ratio "Turbine against pump";
  Real torque_ratio "Turbine against pump";
  Real loss_power(unit = "W") "Heats the fluid";
protected
  constant Real speed_ratios[9] = {0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.98, 1};
  constant Real capacities[9] = {3.4325e-3, 3.6925e-3, 3.5842e-3, 3.1077e-3, 2.2626e-3, 1.5901e-3, 0.8551e-3, 0.3533e-3, 0}
    "Pump torque per squared speed [N.m.s2]";
  constant Real torque_ratios[9] = {1.6797, 1.5194, 1.4008, 1.2860, 1.1215, 1, 1, 1, 1};
  constant Real slowest(unit = "rad/s") = 1 "Of both; only keeps the ratio finite";
  Real forward(unit = "N.m") "On the pump; none in overrun";
  Real backward(unit = "N.m") "On the turbine; only in overrun";
equation
  pump_speed = der(a.phi);
  turbine_speed = der(b.phi);
  speed_ratio = turbine_speed/max(pump_speed, slowest);
  torque_ratio = Tables.smooth1D(speed_ratio, speed_ratios, torque_ratios);
  forward = scale*Tables.smooth1D(speed_ratio, speed_ratios, capacities)*pump_speed*pump_speed;
  backward = scale*Tables.smooth1D(pump_speed/max(turbine_speed, slowest), speed_ratios, capacities)*
    turbine_speed*turbine_speed;
  a.tau = forward - backward;
  b.tau = backward - torque_ratio*forward;
  loss_power = a.tau*pump_speed + b.tau*turbine_speed;
end TorqueConverter;
