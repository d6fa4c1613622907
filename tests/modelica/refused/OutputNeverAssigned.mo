model OutputNeverAssigned
  function f
    input Real x;
    output Real y;
    output Real z; // refused: not definitely assigned
  algorithm
    y := 2 * x;
  end f;
  Real a;
  output Real y;
equation
  (y, a) = f(time);
end OutputNeverAssigned;
