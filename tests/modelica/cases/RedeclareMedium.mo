// A replaceable package with constants: the way media are exchanged.
package RedeclareMedium
  partial package Medium
    constant Real density = 1;
  end Medium;
  package Water
    extends Medium(density = 1000);
  end Water;
  package Oil
    extends Medium(density = 850);
  end Oil;
  model Tank
    replaceable package Fluid = Water constrainedby Medium;
    input Real h;
    output Real p = Fluid.density * 9.81 * h + Fluid.density;
  end Tank;
  model Test
    input Real h(start = 1.5);
    Tank a(h = h);
    Tank b(redeclare package Fluid = Oil, h = h);
    output Real water = a.p;
    output Real oil = b.p;
  end Test;
end RedeclareMedium;
