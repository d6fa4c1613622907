model WhenWithSeveralResults // refused: several results in a when-clause
  function f
    input Real x;
    output Real y;
    output Real z;
  algorithm
    y := x;
    z := 2 * x;
  end f;
  output Real a(start = 0, fixed = true);
  output Real b(start = 0, fixed = true);
equation
  when time > 0.5 then
    (a, b) = f(time);
  end when;
end WhenWithSeveralResults;
