// Records as arguments and results of functions, nested records, records in arrays.
package FunctionRecord
  record Point
    Real x;
    Real y;
  end Point;
  record Segment
    Point from;
    Point to;
    Real weight = 2;
  end Segment;
  function squared_length
    input Segment s;
    output Real l;
  algorithm
    l := s.weight * ((s.to.x - s.from.x) ^ 2 + (s.to.y - s.from.y) ^ 2);
  end squared_length;
  function mirrored
    input Point p;
    output Point q;
  algorithm
    q.x := p.y;
    q.y := p.x;
  end mirrored;
  model Test
    input Real u(start = 3);
    Point a(x = u, y = 1);
    Point b;
    Segment s(from = a, to(x = 0, y = 0));
    output Real y;
    output Real z;
  equation
    b = mirrored(a);
    y = squared_length(s);
    z = b.x - 2 * b.y;
  end Test;
end FunctionRecord;
