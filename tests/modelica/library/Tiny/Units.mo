within Tiny;
package Units "Types with units"
  type Angle = Real(final quantity = "Angle", final unit = "rad", displayUnit = "deg");
  type AngularVelocity = Real(final quantity = "AngularVelocity", final unit = "rad/s");
  type AngularAcceleration = Real(final quantity = "AngularAcceleration", final unit = "rad/s2");
  type Torque = Real(final quantity = "Torque", final unit = "N.m");
  type Inertia = Real(final quantity = "MomentOfInertia", final unit = "kg.m2", min = 0);
  type SpringConstant = Real(final quantity = "RotationalSpringConstant", final unit = "N.m/rad", min = 0);
  type DampingConstant = Real(final quantity = "RotationalDampingConstant", final unit = "N.m.s/rad", min = 0);
end Units;
