package SameFunctionName
  model A
    function f // refused: 'f'
      input Real x;
      output Real y;
    algorithm
      y := x;
    end f;
    output Real y = f(1);
  end A;
  model B
    function f
      input Real x;
      output Real y;
    algorithm
      y := 10 * x;
    end f;
    output Real y = f(1);
  end B;
  model Test
    A a;
    B b;
    output Real y = a.y + 100 * b.y;
  end Test;
end SameFunctionName;
