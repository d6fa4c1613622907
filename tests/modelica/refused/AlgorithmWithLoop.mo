model AlgorithmWithLoop // refused: algorithm
  input Real u(start = 1);
  output Real y;
algorithm
  y := 0;
  for i in 1:3 loop
    y := y + u * i;
  end for;
end AlgorithmWithLoop;
