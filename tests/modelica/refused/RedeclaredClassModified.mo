package RedeclaredClassModified
  partial block Law
    output Real y;
  end Law;
  block Linear
    extends Law;
    parameter Real k = 2;
  equation
    y = k * time;
  end Linear;
  block Cubic
    extends Law;
    parameter Real k = 1;
  equation
    y = k * time ^ 3;
  end Cubic;
  model Plant
    replaceable block Kind = Linear constrainedby Law;
    Kind part;
  end Plant;
  model Test
    Plant plant(redeclare block Kind = Cubic(k = 0.5)); // refused: redeclaration
    output Real y = plant.part.y;
  end Test;
end RedeclaredClassModified;
