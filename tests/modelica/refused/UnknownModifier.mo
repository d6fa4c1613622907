package UnknownModifier
  model Part
    parameter Real k = 1;
    output Real y = k;
  end Part;
  model Test
    Part part(gain = 2); // refused: gain
    output Real y = part.y;
  end Test;
end UnknownModifier;
