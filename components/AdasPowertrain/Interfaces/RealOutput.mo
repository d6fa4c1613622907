within AdasPowertrain.Interfaces;
connector RealOutput = output Real "Signal out";
