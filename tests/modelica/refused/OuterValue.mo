package OuterValue
  model World
    parameter Boolean heavy = false;
  end World;
  model Body
    outer World world;
    parameter Boolean is_heavy = world.heavy; // refused: of an outer component
    output Real y = 2 if is_heavy;
  end Body;
  model Test
    parameter Boolean heavy = true;
    inner World world(heavy = heavy);
    Body body;
    output Real y = time;
  end Test;
end OuterValue;
