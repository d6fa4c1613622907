// Packages in packages, constants that depend on constants, three ways to import, names looked up outwards.
package NestedPackages
  constant Real g = 9.81;
  package Units
    type Force = Real(unit = "N");
    constant Real kilo = 1000;
    package Inner
      constant Real both = kilo * g;
      function weight
        input Real m;
        output Force f;
      algorithm
        f := m * g;
      end weight;
    end Inner;
  end Units;
  model Test
    import NestedPackages.Units;
    import K = NestedPackages.Units.Inner;
    import NestedPackages.Units.Inner.*;
    import NestedPackages.Units.{Force, kilo};
    input Real u(start = 2);
    output Force f;
    output Real y;
    output Real z;
  equation
    f = weight(u);
    y = Units.kilo * u + K.both;
    z = kilo + both / g;
  end Test;
end NestedPackages;
