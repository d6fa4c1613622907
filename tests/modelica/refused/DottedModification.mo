package DottedModification
  model Part
    parameter Real q = 1;
    Real x(start = 1, fixed = true);
  equation
    der(x) = 0;
  end Part;
  model Holder
    Part part(q = 2);
  end Holder;
  model Test
    Holder one(part.q = 4); // refused: the modification of 'part.q'
    Holder two(part(q = 4), part.x.start = 2); // refused: the modification of 'part.x.start'
    Holder three, four(part.x(start = 5)); // refused: the modification of 'part.x'
    output Real y = one.part.q + two.part.x + four.part.x;
  end Test;
end DottedModification;
