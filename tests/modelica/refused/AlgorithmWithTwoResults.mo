model AlgorithmWithTwoResults // refused: multi-output algorithm
  input Real u(start = 1);
  Real z;
  output Real y;
algorithm
  z := 2 * u + 1;
  y := z + 1;
end AlgorithmWithTwoResults;
