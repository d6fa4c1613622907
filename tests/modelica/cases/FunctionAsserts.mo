// Assertions in functions: they hold where they are reached, and would not hold in the branches that are not taken.
model FunctionAsserts
  function quotient
    input Real a;
    input Real b;
    output Real y;
  algorithm
    assert(abs(b) > 0.1, "the divisor is too small");
    y := a / b;
  end quotient;
  function slope "of a secant; the quotient is reached in one branch only"
    input Real x;
    output Real y;
  algorithm
    if x < 0.2 then
      y := 5;
    else
      y := quotient(1, x);
    end if;
    for i in 1:3 loop
      assert(y < 6 + i or x < 0, "out of bounds");
    end for;
  end slope;
  output Real y = slope(time);
  output Real z = if time > 0.5 then quotient(time, time - 0.3) else 0;
end FunctionAsserts;
