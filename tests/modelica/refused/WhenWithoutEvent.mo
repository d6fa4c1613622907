model WhenWithoutEvent
  Real x(start = 0, fixed = true);
  discrete Real d(start = 0, fixed = true);
  output Real y;
equation
  der(x) = 1;
  when noEvent(x > 0.5) then // refused: when
    d = time;
  end when;
  y = d;
end WhenWithoutEvent;
