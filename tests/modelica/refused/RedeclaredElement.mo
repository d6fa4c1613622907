package RedeclaredElement
  model Part
    parameter Real p = 1;
    parameter Real q = 2;
    output Real y = p + 10 * q;
  end Part;
  model Other
    extends Part(q = 5);
  end Other;
  model Holder
    replaceable Part part(p = 3);
  end Holder;
  model Changed
    extends Holder;
    redeclare Other part(q = 8); // refused: the redeclaration of 'part'
  end Changed;
  model Test
    Changed changed;
    output Real y = changed.part.y;
  end Test;
end RedeclaredElement;
