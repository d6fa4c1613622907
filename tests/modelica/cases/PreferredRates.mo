// A reinit keeps the other states: the relative speed that is preferred, though no equation has its derivative.
model PreferredRates
  parameter Real d = 2 "damping of two bodies of 1 kg";
  Real s1(start = 0, fixed = true, stateSelect = StateSelect.always);
  Real v1(start = 1, fixed = true, stateSelect = StateSelect.always);
  Real s2;
  Real v2;
  Real s_rel(start = 0, fixed = true, stateSelect = StateSelect.prefer);
  Real v_rel(start = 1, fixed = true, stateSelect = StateSelect.prefer);
  output Real first;
  output Real second;
  output Real gap;
equation
  v1 = der(s1);
  v2 = der(s2);
  s_rel = s2 - s1;
  v_rel = der(s_rel);
  der(v1) = d*v_rel;
  der(v2) = -d*v_rel;
  when time > 0.5 then
    reinit(v1, 0);
  end when;
  first = v1;
  second = v2;
  gap = s_rel;
end PreferredRates;
