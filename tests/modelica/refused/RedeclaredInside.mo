model RedeclaredInside
  block One
    output Real y = 1;
  end One;
  block Two
    extends One(y = 2);
  end Two;
  model Base
    replaceable One source;
    replaceable block Kind = One;
    Kind kind;
  end Base;
  model Holder
    Base base;
  end Holder;
  Holder first(base(redeclare Two source)); // refused: the redeclaration of 'source' inside another modification
  Holder second(base(redeclare block Kind = Two)); // refused: the redeclaration of a class inside another modification
  output Real y = first.base.source.y + second.base.kind.y;
end RedeclaredInside;
