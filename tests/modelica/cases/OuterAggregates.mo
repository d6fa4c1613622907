// Arrays and records of an outer component: in equations, in connections and as an argument of a function.
package OuterAggregates
  connector RealOutput = output Real;
  connector RealInput = input Real;
  record Data
    Real a[2];
    Real b;
  end Data;
  function weighted
    input Data data;
    input Real k;
    output Real y;
  algorithm
    y := data.a[1] + k * data.a[2] + data.b;
  end weighted;
  model World
    parameter Real k = 5;
    RealOutput u[2] = {time, 2};
    Real g[2];
    Data data;
  equation
    g = {3, time};
    data.a = {1, time};
    data.b = k;
  end World;
  model Body
    outer World world;
    RealInput v[2];
    Real z[2];
    Real y = weighted(world.data, 10);
  equation
    connect(world.u, v);
    z = 2 * world.g + v;
  end Body;
  model Test
    inner World world;
    Body body;
    output Real y = body.y;
    output Real z[2] = body.z;
  end Test;
end OuterAggregates;
