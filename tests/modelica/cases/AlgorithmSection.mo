// Algorithms in a model: each gives one variable; a value corrected under a condition, a choice of three.
model AlgorithmSection
  input Real u(start = 1.5);
  Real a;
  output Real y;
  output Real z;
algorithm
  a := 2 * u + 1;
algorithm
  y := 3 * a;
  if a > 3.5 then
    y := a + 100;
  end if;
algorithm
  if time < 0.3 then
    z := y;
  elseif time < 0.6 then
    z := y - a;
  else
    z := -1;
  end if;
end AlgorithmSection;
