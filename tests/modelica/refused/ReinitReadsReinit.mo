model ReinitReadsReinit
  Real x(start = 0, fixed = true);
  Real w(start = 10, fixed = true);
  output Real y;
equation
  der(x) = 1;
  der(w) = -1;
  when time >= 0.5 then
    reinit(x, w); // refused: 'x'
    reinit(w, x); // refused: 'w'
  end when;
  y = x;
end ReinitReadsReinit;
