// A record whose fields are bound to parameters, handed to a function, and held by another record.
package RecordBinding
  record Point
    Real x;
    Real y;
  end Point;
  record Line
    Point from;
    Point to;
  end Line;
  function length
    input Line l;
    output Real s;
  algorithm
    s := sqrt((l.to.x - l.from.x) ^ 2 + (l.to.y - l.from.y) ^ 2);
  end length;
  model Test
    parameter Real k = 3;
    parameter Point a(x = k, y = 0);
    parameter Line l(from = a, to(x = 0, y = 4));
    output Real y;
    output Real z;
  equation
    y = length(l);
    z = l.from.x + time;
  end Test;
end RecordBinding;
