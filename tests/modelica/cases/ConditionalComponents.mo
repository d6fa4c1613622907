// Conditional components with their connections: one there, one not, decided by parameters.
package ConditionalComponents
  connector RealInput = input Real;
  connector RealOutput = output Real;
  block Gain
    parameter Boolean use_input = false;
    parameter Real k = 2;
    RealInput u;
    RealInput extra if use_input;
    RealOutput y;
  protected
    RealInput inner_extra;
  equation
    connect(extra, inner_extra);
    if not use_input then
      inner_extra = 10;
    end if;
    y = k * u + inner_extra;
  end Gain;
  model Test
    input Real u(start = 3);
    Gain a;
    Gain b(use_input = true, k = 4);
    output Real y;
    output Real z;
  equation
    a.u = u;
    connect(a.y, b.u);
    b.extra = 1000 * u;
    y = a.y;
    z = b.y;
  end Test;
end ConditionalComponents;
