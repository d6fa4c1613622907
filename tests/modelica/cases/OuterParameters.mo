// Values of an outer component that decide what there is: the inner one's, not those of its class. And an outer
// component of a partial class, and a function with an assert in the value of a parameter.
package OuterParameters
  type Kind = enumeration(small, large);
  model World
    parameter Boolean rigid = true;
    parameter Boolean heavy = false;
    parameter Integer n = 1;
    parameter Kind kind = Kind.small;
    parameter Real g = 9.81;
  end World;
  partial model Road
    parameter Real slope = 0;
  end Road;
  model Hill
    extends Road(slope = 0.25);
  end Hill;
  connector Pin
    Real e;
    flow Real f;
  end Pin;
  model Source
    Pin p;
  equation
    p.e = 3;
  end Source;
  model Part
    parameter Boolean has_source = false;
    parameter Integer n = 5;
    Pin p if has_source;
    Source source if has_source;
    Real x[n] = fill(2.0, n);
    Real y = sum(x);
  equation
    connect(p, source.p);
  end Part;
  model Body
    outer World world;
    outer Road road;
    parameter Boolean is_soft(start = false) = not world.rigid;
    parameter Kind kind = world.kind;
    Source large if kind == Kind.large;
    Part part(has_source = world.heavy, n = world.n);
    Part soft(has_source = is_soft);
    Real weight = world.g * road.slope;
  end Body;
  function positive
    input Real u;
    input Integer world = 1 "the name of a component, and not one";
    output Real y;
  algorithm
    assert(u > 0, "must be positive");
    y := sqrt(u)*world;
  end positive;
  model Test
    parameter Real area = 4;
    parameter Real side = positive(area);
    inner World world(rigid = false, heavy = true, n = 3, kind = Kind.large, g = 10);
    inner Hill road;
    Body body;
    output Real a = body.part.source.p.e;
    output Real b = body.soft.source.p.e;
    output Real c = body.part.y;
    output Real d = body.weight;
    output Real e = side * time;
    output Real f = body.large.p.e;
  end Test;
end OuterParameters;
