package ConstrainedWithChanges
  partial model Part
    parameter Real gain = 1;
    output Real y;
  end Part;
  model Squared
    extends Part(gain = 2);
    parameter Real height = 3;
  equation
    y = gain * height;
  end Squared;
  model Plant
    replaceable model Kind = Squared(height = 4) constrainedby Part(gain = 9); // refused: 'constrainedby'
    replaceable Squared same(gain = 9) constrainedby Part(gain = 9);
    replaceable Squared other(gain = 8) constrainedby Part(gain = 9); // refused: 'constrainedby'
    Kind part;
  end Plant;
  model Test
    Plant plant;
    output Real y = plant.part.y;
  end Test;
end ConstrainedWithChanges;
