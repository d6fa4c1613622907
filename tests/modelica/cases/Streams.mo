// Stream connectors between two components: inStream takes the other side's value.
package Streams
  connector Port
    Real p;
    flow Real m;
    stream Real h;
  end Port;
  model Reservoir
    Port port;
    parameter Real p = 1;
    parameter Real h = 5;
  equation
    port.p = p;
    port.h = h;
  end Reservoir;
  model Pipe
    Port a;
    Port b;
    parameter Real k = 2;
  equation
    a.m + b.m = 0;
    a.m = k * (a.p - b.p);
    a.h = inStream(b.h) + 1;
    b.h = inStream(a.h) + 1;
  end Pipe;
  model Test
    Reservoir left(p = 3, h = 5);
    Reservoir right(p = 1, h = 9);
    Pipe pipe;
    output Real flow_rate = pipe.a.m;
    output Real forward = pipe.b.h;
    output Real backward = pipe.a.h;
    output Real carried;
  equation
    connect(left.port, pipe.a);
    connect(pipe.b, right.port);
    carried = inStream(right.port.h);
  end Test;
end Streams;
