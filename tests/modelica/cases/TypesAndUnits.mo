// Types with units, display units, minimum, maximum, nominal and start, refined twice and modified in a declaration.
package TypesAndUnits
  type Torque = Real(quantity = "Torque", unit = "N.m");
  type PositiveTorque = Torque(min = 0, max = 500, nominal = 100);
  type Percent = Real(min = 0, max = 1);
  model Test "torque of a machine"
    input PositiveTorque demand(start = 50) "what is asked for";
    parameter Percent efficiency(max = 0.99) = 0.9 "of the machine";
    parameter Torque loss = 5;
    output Torque torque "what is given";
    output Real speed(unit = "rad/s", displayUnit = "rev/min", start = 10, fixed = true);
  equation
    torque = efficiency * demand - loss;
    10 * der(speed) = torque;
  end Test;
end TypesAndUnits;
