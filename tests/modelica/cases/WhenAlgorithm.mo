// when in an algorithm: a discrete variable read and written, with an if inside the clause.
model WhenAlgorithm
  Real x(start = 0, fixed = true);
  discrete Real d(start = 1, fixed = true);
  output Real y;
equation
  der(x) = 1;
  y = d + x;
algorithm
  when sample(0.2, 0.2) then
    if x > 0.5 then
      d := 2 * pre(d);
    else
      d := pre(d) + 1;
    end if;
  end when;
end WhenAlgorithm;
