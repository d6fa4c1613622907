package RedeclaredAgainstConstraint
  model Part
    parameter Real gain = 1;
    output Real y = gain;
  end Part;
  model Strong
    extends Part(gain = 77);
  end Strong;
  model Plant
    replaceable Part first(gain = 2) constrainedby Part;
    replaceable Part second(gain = 2) constrainedby Part;
    replaceable Part third(gain = 2);
  end Plant;
  model Test
    Plant plant(
      redeclare Strong first, // refused: the redeclaration of 'first'
      redeclare Strong second(gain = 3),
      redeclare Strong third);
    output Real y = plant.first.y + plant.second.y + plant.third.y;
  end Test;
end RedeclaredAgainstConstraint;
