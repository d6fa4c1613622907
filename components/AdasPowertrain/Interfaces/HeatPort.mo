within AdasPowertrain.Interfaces;
connector HeatPort "Where heat is taken from or given to a body"
  Real T(unit = "K") "Temperature";
  flow Real Q_flow(unit = "W") "Heat into the component";
end HeatPort;
