// Loops and comprehensions over all values of an enumeration.
package EnumerationLoops
  type Axle = enumeration(front, middle, rear);

  model Test
    parameter Real share[Axle] = {1, 2, 4};
    output Real force[Axle];
    output Real total;
    output Real squares[3];
  equation
    for axle in Axle loop
      force[axle] = share[axle]*time;
    end for;
    total = sum(force[axle] for axle in Axle) + force[Axle.rear];
    squares = {share[axle]^2 for axle in Axle};
  end Test;
end EnumerationLoops;
