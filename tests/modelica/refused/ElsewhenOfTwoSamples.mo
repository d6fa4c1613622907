// when and elsewhen that become true together: the first holds; each alone does its own.
model ElsewhenOfTwoSamples // refused: clock
  discrete Real d(start = 0, fixed = true);
  Real x(start = 0, fixed = true);
  output Real y;
equation
  der(x) = 1;
  when sample(0.1, 0.3) then
    d = pre(d) + 1;
  elsewhen sample(0.1, 0.2) then
    d = pre(d) + 100;
  elsewhen x > 0.65 then
    d = pre(d) + 10000;
  end when;
  y = d;
end ElsewhenOfTwoSamples;
