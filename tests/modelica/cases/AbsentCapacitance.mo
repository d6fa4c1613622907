// A parameter that is 0 for good takes the derivative it multiplies out of the model.
model AbsentCapacitance
  parameter Real C = 0 annotation(Evaluate = true);
  parameter Real R = 2;
  output Real v;

  model Capacitor
    parameter Real C = 1;
    Real v(start = 0);
    Real i;
  equation
    i = C*der(v);
  end Capacitor;

  Capacitor capacitor(final C = C);
protected
  Real load;
equation
  load = capacitor.v/3;
  1 + time - capacitor.v = R*(capacitor.i + load);
  v = capacitor.v;
end AbsentCapacitance;
