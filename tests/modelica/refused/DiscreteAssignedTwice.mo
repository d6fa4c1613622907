model DiscreteAssignedTwice // refused: duplicate discrete
  discrete Real d(start = 0, fixed = true);
  output Real y;
equation
  when time > 0.2 then
    d = 1;
  end when;
  when time > 0.4 then
    d = 2;
  end when;
  y = d;
end DiscreteAssignedTwice;
