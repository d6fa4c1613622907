package MediumFunction
  partial package Medium
    constant Real density = 1;
    replaceable partial function pressure // refused: 'Fluid.pressure'
      input Real h;
      output Real p;
    end pressure;
  end Medium;
  package Water
    extends Medium(density = 1000); // refused: 'density'
    redeclare function extends pressure
    algorithm
      p := density * 9.81 * h;
    end pressure;
  end Water;
  package Oil
    extends Medium(density = 850); // refused: 'density'
    redeclare function extends pressure
    algorithm
      p := density * 9.81 * h + 5;
    end pressure;
  end Oil;
  model Tank
    replaceable package Fluid = Water constrainedby Medium;
    input Real h;
    output Real p = Fluid.pressure(h);
  end Tank;
  model Test
    input Real h(start = 1.5);
    Tank a(h = h);
    Tank b(redeclare package Fluid = Oil, h = h);
    output Real y = a.p + b.p;
  end Test;
end MediumFunction;
