package InheritedModelByPackage
  package Base
    model Part
      output Real y = time;
    end Part;
  end Base;
  package Other
    extends Base;
  end Other;
  model Test
    Other.Part part; // refused: type reference: 'Other.Part'
    output Real y = part.y;
  end Test;
end InheritedModelByPackage;
