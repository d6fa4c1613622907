within AdasPowertrain.Tables;
type Extrapolation = enumeration(
    hold "The value at the end",
    linear "The slope at the end goes on",
    error "Fails, naming the table") "What a table gives outside its axes";
