package ExpandableTypes
  expandable connector Bus
  end Bus;
  connector RealInput = input Real;
  connector IntegerOutput = output Integer;
  model Source
    Bus bus;
    IntegerOutput y = 1;
  equation
    connect(y, bus.gear);
  end Source;
  model Test // refused: incompatible connector types
    Bus bus;
    Source source;
    RealInput u;
  equation
    connect(bus.gear, u);
    connect(source.bus, bus);
  end Test;
end ExpandableTypes;
