package Overconstrained
  type Angle
    extends Real;
    function equalityConstraint
      input Angle a;
      input Angle b;
      output Real residue[0];
    algorithm
    end equalityConstraint;
  end Angle;
  connector Plug
    Angle theta;
    Real v;
    flow Real i;
  end Plug;
  model Source
    Plug p;
  equation
    Connections.root(p.theta);
    p.theta = 3 * time;
    p.v = 1;
  end Source;
  model Line
    Plug a;
    Plug b;
    parameter Real R = 1;
  equation
    Connections.branch(a.theta, b.theta);
    a.theta = b.theta;
    a.v - b.v = R * a.i;
    a.i + b.i = 0;
  end Line;
  model Load
    Plug p;
  equation
    p.i = p.v;
  end Load;
  model Test "a loop of two lines" // refused: unbalanced
    Source source;
    Line first(R = 1);
    Line second(R = 2);
    Load load;
    output Real y = load.p.v;
    output Real z = load.p.theta;
  equation
    connect(source.p, first.a);
    connect(source.p, second.a);
    connect(first.b, load.p);
    connect(second.b, load.p);
  end Test;
end Overconstrained;
