package ExpandableFlow
  connector Pin
    Real e;
    flow Real f;
  end Pin;
  expandable connector Bus
  end Bus;
  model Part
    Pin pin; // refused: has a flow
    Bus bus;
  equation
    connect(pin, bus.pin);
  end Part;
  model Test
    Part part;
    output Real y = time;
  end Test;
end ExpandableFlow;
