package ExpandableWithoutSource
  expandable connector Bus
  end Bus;
  connector RealInput = input Real;
  model Reader
    Bus bus;
    RealInput u;
  equation
    connect(bus.speed, u);
  end Reader;
  model Test // refused: unbalanced
    Reader one;
    Reader other;
    output Real y = one.u;
  equation
    connect(one.bus, other.bus);
  end Test;
end ExpandableWithoutSource;
