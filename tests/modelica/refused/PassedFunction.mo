model PassedFunction // refused: class, not a variable
  partial function law
    input Real x;
    output Real y;
  end law;
  function square
    extends law;
  algorithm
    y := x * x;
  end square;
  function twice
    input law f;
    input Real x;
    output Real y;
  algorithm
    y := f(f(x));
  end twice;
  output Real y;
equation
  y = twice(square, time);
end PassedFunction;
