// An expandable connector with declared members as a signal bus.
package ExpandableBus
  expandable connector Bus
    Real speed;
    Real torque;
  end Bus;
  connector RealInput = input Real;
  connector RealOutput = output Real;
  model Source
    RealOutput y;
    parameter Real k = 1;
  equation
    y = k * time;
  end Source;
  model Sink
    RealInput u;
    output Real twice;
  equation
    twice = 2 * u;
  end Sink;
  model Test
    Bus bus;
    Source speed(k = 3);
    Source torque(k = 7);
    Sink a;
    Sink b;
    output Real y = a.twice;
    output Real z = b.twice;
  equation
    connect(speed.y, bus.speed);
    connect(torque.y, bus.torque);
    connect(bus.speed, a.u);
    connect(bus.torque, b.u);
  end Test;
end ExpandableBus;
