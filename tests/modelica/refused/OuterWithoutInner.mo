package OuterWithoutInner
  model World
    parameter Real g = 9.81;
  end World;
  partial model NoDefault
    parameter Real g;
  end NoDefault;
  model Body
    outer NoDefault world;
    output Real y = world.g;
  end Body;
  model Test // refused: partial model
    Body body;
    output Real y = body.y;
  end Test;
end OuterWithoutInner;
