// Several states set anew by one clause, one from the other; a relation on them changes by the reinit itself.
model ReinitStates
  Real x(start = 0, fixed = true);
  Real w(start = 10, fixed = true);
  Boolean high;
  discrete Integer changes(start = 0, fixed = true);
  output Real y;
  output Real z;
  output Integer n;
equation
  der(x) = 1;
  der(w) = -1;
  when time >= 0.5 then
    reinit(x, pre(w));
    reinit(w, pre(x));
  end when;
  high = x > 5;
  when change(high) then
    changes = pre(changes) + 1;
  end when;
  y = x;
  z = w;
  n = changes;
end ReinitStates;
