within Tiny.Rotational;
model IdealGear "Ideal gear without inertia"
  extends Interfaces.PartialElementaryTwoFlangesAndSupport;
  parameter Real ratio(start = 1) "Transmission ratio (flange_a.phi/flange_b.phi)";
  Units.Angle phi_a;
  Units.Angle phi_b;
equation
  phi_a = flange_a.phi - internalSupport.phi;
  phi_b = flange_b.phi - internalSupport.phi;
  phi_a = ratio * phi_b;
  0 = ratio * flange_a.tau + flange_b.tau;
end IdealGear;
