model RedeclaredInherited
  block One
    output Real y = 1;
  end One;
  block Two
    extends One(y = 2);
  end Two;
  model Base
    replaceable One source;
    Real x, y = source.y + x;
  equation
    x = source.y;
  end Base;
  model Middle
    extends Base;
  end Middle;
  model Top
    extends Middle(redeclare Two source); // refused: 'source', which 'Middle' inherits
  end Top;
  model Other = Middle(redeclare Two source); // refused: 'source', which 'Middle' inherits
  Top top;
  Other other;
  Middle right(redeclare Two source);
  output Real y = top.y + other.y + right.y;
end RedeclaredInherited;
