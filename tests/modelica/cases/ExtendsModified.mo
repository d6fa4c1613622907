// Several base classes, modified start values and bindings, equations inherited twice removed, a modifier of an element of a component.
package ExtendsModified
  partial model Lag
    parameter Real T = 1;
    Real x(start = 0, fixed = true);
    input Real u;
  equation
    T * der(x) = u - x;
  end Lag;
  partial model Observed
    output Real y;
    parameter Real offset = 0;
  end Observed;
  model LagWithOutput
    extends Lag(T = 0.5);
    extends Observed(offset = 3);
  equation
    y = x + offset;
  end LagWithOutput;
  model Test
    extends LagWithOutput(T = 0.25, x(start = 2), u = 1 + other.y);
    LagWithOutput other(offset = -1, x(start = 5), u = 0);
    output Real z = other.y;
  end Test;
end ExtendsModified;
