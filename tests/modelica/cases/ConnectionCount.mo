// cardinality(): equations that depend on whether a connector is connected.
package ConnectionCount
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  model Part
    Pin p;
    parameter Real v = 1;
  equation
    if cardinality(p) == 0 then
      p.v = -5;
    else
      p.v = v;
    end if;
  end Part;
  model Load
    Pin p;
    Real i;
  equation
    i = p.i;
    p.i = 2 * p.v;
  end Load;
  model Test
    Part alone;
    Part connected(v = 3);
    Load load;
    output Real y = alone.p.v;
    output Real z = load.i;
  equation
    connect(connected.p, load.p);
  end Test;
end ConnectionCount;
