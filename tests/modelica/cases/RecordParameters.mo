// Records as parameter sets: a record constant, a record parameter modified, one handed down to a component.
package RecordParameters
  record Data
    parameter Real k = 1;
    parameter Real c[2] = {1, 2};
    parameter Integer n = 3;
  end Data;
  record Sport = Data(k = 5, c = {3, 4});
  model Part
    parameter Data data;
    input Real u;
    output Real y = data.k * u + data.c[2] * data.n;
  end Part;
  model Test
    parameter Data data(n = 10);
    parameter Sport sport;
    input Real u(start = 2);
    Part a(data = data, u = u);
    Part b(data = sport, u = u);
    Part c(data(k = 7), u = u);
    output Real y[3] = {a.y, b.y, c.y};
  end Test;
end RecordParameters;
