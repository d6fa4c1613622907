// Connectors inside and outside of a component: the signs of flows change at a boundary; one connector is left open.
package HierarchicalConnections
  connector Flange
    Real phi;
    flow Real tau;
  end Flange;
  model Spring
    Flange a;
    Flange b;
    parameter Real c = 100;
  equation
    a.tau = c * (a.phi - b.phi);
    a.tau + b.tau = 0;
  end Spring;
  model TwoSprings
    Flange left;
    Flange right;
    Flange middle;
    Spring first(c = 200);
    Spring second(c = 50);
  equation
    connect(left, first.a);
    connect(first.b, second.a);
    connect(first.b, middle);
    connect(second.b, right);
  end TwoSprings;
  model Inertia
    Flange flange;
    parameter Real J = 1;
    Real w(start = 0, fixed = true);
    Real phi(start = 0, fixed = true);
  equation
    flange.phi = phi;
    der(phi) = w;
    J * der(w) = flange.tau;
  end Inertia;
  model Wall
    Flange flange;
  equation
    flange.phi = 0;
  end Wall;
  model Test
    TwoSprings chain;
    Inertia inertia(J = 2, phi(start = 0.1));
    Wall wall;
    output Real angle = inertia.phi;
    output Real middle = chain.middle.phi;
    output Real load = wall.flange.tau;
  equation
    connect(wall.flange, chain.left);
    connect(chain.right, inertia.flange);
  end Test;
end HierarchicalConnections;
