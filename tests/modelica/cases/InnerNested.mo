// An inner element below the top counts for what is inside it; another at the top for the rest.
package InnerNested
  model Ground
    Real height;
  end Ground;

  model Leaf
    outer Ground g;
    output Real y = 2*g.height;
  end Leaf;

  model Branch
    parameter Real k = 1;
    inner Ground g(height = k*time);
    Leaf leaf;
  end Branch;

  model Twig "without an inner element of its own"
    Leaf leaf;
  end Twig;

  model Test
    parameter Real k = 3;
    inner Ground g(height = -time);
    Branch one;
    Branch other(k = k);
    Twig twig;
    Leaf leaf;
    output Real y[4];
  equation
    y = {one.leaf.y, other.leaf.y, twig.leaf.y, leaf.y};
  end Test;
end InnerNested;
