package OuterClass
  model One
    output Real y = 11;
  end One;
  model Two
    output Real y = 22;
  end Two;
  model Part
    outer model Kind = One; // refused: an outer model
    Kind kind;
  end Part;
  model Test
    inner model Kind = Two;
    Part part;
    output Real y = part.kind.y;
  end Test;
end OuterClass;
