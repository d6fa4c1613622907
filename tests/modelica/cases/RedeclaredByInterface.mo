// Controllers that have the interface of another without extending it, redeclared through classes that inherit them.
package RedeclaredByInterface
  connector In = input Real;
  connector Out = output Real;
  partial model Controller
    In wanted;
    In is;
    Out command;
  end Controller;
  model Gain "does not extend Controller"
    parameter Real k = 2;
    In wanted;
    In is;
    Out command;
    Integer extra = 3;
  equation
    command = k*(wanted - is);
  end Gain;
  model Integral
    extends Controller;
    parameter Real ti = 1;
    Real x(start = 0, fixed = true);
  equation
    der(x) = (wanted - is)/ti;
    command = x;
  end Integral;
  model Sensor
    In u;
    Out y;
  equation
    y = u;
  end Sensor;
  model Doubled
    In u;
    Out y;
    parameter Real factor = 2;
  equation
    y = factor*u;
  end Doubled;
  partial model Loop
    replaceable Controller controller;
    replaceable Sensor sensor;
    Real x(start = 0, fixed = true);
  equation
    der(x) = controller.command;
    sensor.u = x;
    controller.is = sensor.y;
    controller.wanted = 1;
  end Loop;
  model First
    extends Loop(redeclare replaceable Gain controller, redeclare replaceable Sensor sensor);
  end First;
  model Second
    extends First(redeclare replaceable Doubled sensor);
  end Second;
  model Third
    extends Second(
      redeclare replaceable Integral controller(ti = 0.25), // a comment
      redeclare replaceable Doubled sensor(factor = 0.5));
  end Third;
  model Test
    extends Third(controller(ti = 0.5));
    output Real y = x;
    output Real command = controller.command;
  end Test;
end RedeclaredByInterface;
