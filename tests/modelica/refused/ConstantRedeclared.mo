package ConstantRedeclared
  package Base
    replaceable constant Real d = 2;
  end Base;
  package Other
    extends Base;
    redeclare constant Real d = 100; // refused: redeclaration of a constant
  end Other;
  model Test
    output Real z = Other.d;
  end Test;
end ConstantRedeclared;
