// Expandable connectors whose members only connections declare: in a bus that is a member itself, through an outer bus,
// from one class of buses to another; Real, Integer, Boolean and an array. `Idle` gives members that no other bus has.
package ExpandableMembers
  expandable connector Bus "Nothing is declared"
  end Bus;
  expandable connector Engine
  end Engine;
  expandable connector Other
    extends Engine;
  end Other;
  connector RealInput = input Real;
  connector RealOutput = output Real;
  connector IntegerOutput = output Integer;
  connector IntegerInput = input Integer;
  connector BooleanOutput = output Boolean;
  connector BooleanInput = input Boolean;
  model Sensor
    parameter Real k = 1;
    RealOutput y = k * time;
  end Sensor;
  model Plant
    Bus bus;
    Engine engine;
    Sensor speed(k = 3);
    RealOutput ends[2] = {time, -time};
    IntegerOutput gear = if time > 0.55 then 2 else 1;
    BooleanOutput locked = time > 0.35;
  equation
    connect(speed.y, engine.speed);
    connect(engine, bus.engine);
    connect(gear, bus.gear);
    connect(bus.locked, locked);
    connect(bus.ends, ends);
  end Plant;
  model Controller
    Bus bus;
    RealInput u;
    RealInput ends[2];
    IntegerInput gear;
    BooleanInput locked;
    Real x(start = 0, fixed = true);
    Real z = ends[1] - 2 * ends[2] + gear;
  equation
    connect(bus.engine.speed, u);
    connect(ends, bus.ends);
    connect(gear, bus.gear);
    connect(locked, bus.locked);
    der(x) = if locked then u else 0;
  end Controller;
  model Below
    outer Bus shared;
    Sensor torque(k = 7);
  equation
    connect(torque.y, shared.torque);
  end Below;
  model Reader
    Other other;
    RealInput u;
    Real twice = 2 * u;
  equation
    connect(other.torque, u);
  end Reader;
  model Idle
    Bus bus;
    Sensor unused;
  equation
    connect(unused.y, bus.engine.unused);
    connect(unused.y, bus.other);
  end Idle;
  model Test
    Plant plant;
    Controller controller;
    Bus bus;
    inner Bus shared;
    Below below;
    Reader reader;
    output Real x = controller.x;
    output Real z = controller.z;
    output Real twice = reader.twice;
  equation
    connect(plant.bus, bus);
    connect(controller.bus, bus);
    connect(shared, reader.other);
  end Test;
end ExpandableMembers;
