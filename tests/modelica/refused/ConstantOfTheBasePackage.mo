package ConstantOfTheBasePackage
  package Base
    constant Real c = 1, d = 2 * c;
  end Base;
  package Other
    extends Base(d = 100); // refused: constant 'd' of package 'Base'
  end Other;
  model Test
    output Real y = Base.d;
    output Real z = Other.d;
  end Test;
end ConstantOfTheBasePackage;
