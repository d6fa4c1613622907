within Tiny.Interfaces;
partial model PartialElementaryTwoFlangesAndSupport "Two shafts and a housing that may be fixed inside"
  parameter Boolean useSupport = false "= true, if support flange enabled, otherwise implicitly grounded"
    annotation(Evaluate = true, HideResult = true, choices(checkBox = true));
  Flange_a flange_a "Flange of left shaft";
  Flange_b flange_b "Flange of right shaft";
  Support support if useSupport "Support/housing of component";
protected
  InternalSupport internalSupport(tau = -flange_a.tau - flange_b.tau);
  Rotational.Fixed fixed if not useSupport "Fixed support/housing, if not useSupport";
equation
  connect(support, internalSupport.flange);
  connect(fixed.flange, internalSupport.flange);
end PartialElementaryTwoFlangesAndSupport;
