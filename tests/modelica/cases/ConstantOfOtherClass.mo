// A parameter with the name of a constant that a function reads is changed; the constant is not.
package ConstantOfOtherClass
  package Numbers
    constant Real k = 2;
    constant Real m = 10;
  end Numbers;
  function scaled
    input Real x;
    output Real y;
  algorithm
    y := Numbers.k * x + Numbers.m;
  end scaled;
  block Gain
    parameter Real k = 1;
    input Real u;
    output Real y = k * scaled(u);
  end Gain;
  model Mass
    parameter Real m = 1;
    Real v(start = 0, fixed = true);
  equation
    m * der(v) = scaled(0);
  end Mass;
  model Test
    Gain a(k = 3, u = time);
    Gain b(k = 5, u = 2);
    Mass c(m = 4);
    output Real y[3] = {a.y, b.y, c.v};
  end Test;
end ConstantOfOtherClass;
