package RedeclaredToStranger
  model Part
    output Real y = 1;
  end Part;
  model Stranger
    output Real y = time;
  end Stranger;
  model Plant
    replaceable model Kind = Part;
    Kind part;
  end Plant;
  model Test
    Plant plant(redeclare model Kind = Stranger); // refused: which does not extend
    output Real y = plant.part.y;
  end Test;
end RedeclaredToStranger;
