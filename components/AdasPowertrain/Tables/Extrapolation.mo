within AdasPowertrain.Tables;
type Extrapolation = enumeration(
    hold "The value at the end",
    linear "Extrapolated with the slope at the end",
    error "Fails, naming the table") "What a table gives outside its axes";
