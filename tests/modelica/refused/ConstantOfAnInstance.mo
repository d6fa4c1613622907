package ConstantOfAnInstance
  model Part
    constant Real k = 1;
    function f
      output Real y;
    algorithm
      y := k;
    end f;
    output Real y = f();
  end Part;
  model Test
    Part a(k = 2); // refused: constant 'k'
    Part b(k = 3); // refused: constant 'k'
    output Real y = a.y + b.y;
  end Test;
end ConstantOfAnInstance;
