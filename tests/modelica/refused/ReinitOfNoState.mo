model ReinitOfNoState // refused: reinit
  Real x;
  output Real y;
equation
  x = 2 * time;
  when time > 0.5 then
    reinit(x, 0);
  end when;
  y = x;
end ReinitOfNoState;
