// inner and outer over two levels, an inner that hides another, an outer in a component array.
package InnerOuter
  model World
    parameter Real g = 9.81;
  end World;
  model Body
    outer World world;
    parameter Real m = 1;
    output Real weight = m * world.g;
  end Body;
  model Planet
    inner World world(g = 3.7);
    Body body(m = 2);
  end Planet;
  model Pair
    Body bodies[2](m = {3, 4});
    Planet planet;
  end Pair;
  model Test
    inner World world(g = 10);
    Pair pair;
    output Real here = sum(pair.bodies.weight);
    output Real there = pair.planet.body.weight;
  end Test;
end InnerOuter;
