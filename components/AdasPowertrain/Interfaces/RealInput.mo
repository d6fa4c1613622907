within AdasPowertrain.Interfaces;
connector RealInput = input Real "Signal in";
