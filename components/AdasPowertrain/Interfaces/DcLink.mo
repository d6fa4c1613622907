within AdasPowertrain.Interfaces;
connector DcLink "Direct-current link, both poles in one; what flows is power, so that a battery finds its current in closed form"
  Real v(unit="V") "Voltage between the poles";
  flow Real p(unit="W") "Power into the component";
end DcLink;
