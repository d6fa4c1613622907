package InnerBelowTheTop
  model Leaf
    outer Real g;
    output Real y = 2 * g;
  end Leaf;
  model Branch
    inner Real g = time;
    Leaf leaf;
  end Branch;
  model Test // refused: unbalanced
    Branch one;
    Branch other(g = 5);
    output Real y = one.leaf.y + other.leaf.y;
  end Test;
end InnerBelowTheTop;
