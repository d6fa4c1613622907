// Replaceable components and classes redeclared from outside, with constraining classes; a class kept and modified.
package Redeclare
  partial block Law
    input Real u;
    output Real y;
  end Law;
  block Linear
    extends Law;
    parameter Real k = 2;
  equation
    y = k * u;
  end Linear;
  block Cubic
    extends Law;
    parameter Real k = 1;
  equation
    y = k * u ^ 3;
  end Cubic;
  block HalfCubic
    extends Cubic(k = 0.5);
  end HalfCubic;
  model Plant
    replaceable block Kind = Linear constrainedby Law;
    replaceable Linear first(k = 5) constrainedby Law;
    replaceable Linear third constrainedby Law;
    Kind second;
    input Real u;
    output Real y;
  equation
    first.u = u;
    second.u = 3 * u;
    third.u = u + 1;
    y = first.y + 100 * second.y + 10000 * third.y;
  end Plant;
  model Test
    input Real u(start = 2);
    Plant plain(u = u);
    Plant changed(redeclare block Kind = HalfCubic, redeclare Cubic first(k = 7), u = u, third(k = -1));
    output Real a;
    output Real b;
  equation
    a = plain.y;
    b = changed.y;
  end Test;
end Redeclare;
