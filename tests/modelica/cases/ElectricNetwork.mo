// connect with flow sums at nodes of three and four, a ground, sources: linear equations over the whole network.
package ElectricNetwork
  connector Pin
    Real v(unit = "V");
    flow Real i(unit = "A");
  end Pin;
  partial model TwoPin
    Pin p;
    Pin n;
    Real v;
    Real i;
  equation
    v = p.v - n.v;
    i = p.i;
    p.i + n.i = 0;
  end TwoPin;
  model Resistor
    extends TwoPin;
    parameter Real R = 1;
  equation
    v = R * i;
  end Resistor;
  model Source
    extends TwoPin;
    parameter Real V = 1;
  equation
    v = V;
  end Source;
  model Ground
    Pin p;
  equation
    p.v = 0;
  end Ground;
  model Test "a bridge"
    Source source(V = 10);
    Ground ground;
    Resistor r1(R = 1);
    Resistor r2(R = 2);
    Resistor r3(R = 3);
    Resistor r4(R = 4);
    Resistor bridge(R = 5);
    output Real across = bridge.v;
    output Real total = -source.i;
  equation
    connect(source.p, r1.p);
    connect(source.p, r3.p);
    connect(r1.n, r2.p);
    connect(r3.n, r4.p);
    connect(r1.n, bridge.p);
    connect(bridge.n, r4.p);
    connect(r2.n, source.n);
    connect(r4.n, source.n);
    connect(source.n, ground.p);
  end Test;
end ElectricNetwork;
