package ExpandableFlow
  connector Pin
    Real e;
    flow Real f;
  end Pin;
  expandable connector Bus
    Pin pin;
  end Bus;
  model Test // refused: unbalanced
    Bus bus;
    output Real y = time;
  end Test;
end ExpandableFlow;
