model Ride
  Motion.Slider slider(mark = 0.5);
  Motion.Line line;
  Motion.Curve curve;
  output Real s;
  output Boolean is_behind;
  output Real straight;
  output Real curved;
equation
  s = slider.s;
  is_behind = slider.is_behind;
  straight = line.y;
  curved = curve.y;
end Ride;
