model ReinitOfDummy
  Real phi1;
  Real phi2(start = 0, fixed = true, stateSelect = StateSelect.always);
  output Real y;
equation
  phi1 = 3 * phi2 + 1;
  der(phi2) = 1;
  when time > 0.5 then
    reinit(phi1, 0); // refused: phi1
  end when;
  y = phi1 + der(phi1);
end ReinitOfDummy;
