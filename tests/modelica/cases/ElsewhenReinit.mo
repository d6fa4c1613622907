// Branches of one when-clause that set different states anew: in one instant only the first branch acts.
model ElsewhenReinit
  Real x(start = 0, fixed = true);
  Real w(start = 0, fixed = true);
  output Real y[2];
equation
  der(x) = 1;
  der(w) = 1;
  when time >= 0.5 then
    reinit(x, 0);
  elsewhen {time >= 0.25, time >= 0.5} then
    reinit(w, 0);
  end when;
  y = {x, w};
end ElsewhenReinit;
