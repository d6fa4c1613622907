// An algorithm in a model: order of assignments, reassignment, a loop, an if without else, a vector.
model AlgorithmReassigns // refused: model algorithm
  input Real u(start = 1.5);
  Real a;
  Real v[3];
  output Real y;
  output Real z;
algorithm
  a := 2 * u;
  a := a + 1;
  for i in 1:3 loop
    v[i] := a * i;
  end for;
  y := v[3];
  if a > 3.5 then
    y := y + 100;
  end if;
  z := y - v[2];
end AlgorithmReassigns;
