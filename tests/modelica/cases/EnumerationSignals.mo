// Enumerations as inputs, outputs, parameters, array indices and in comparisons.
model EnumerationSignals
  type Mode = enumeration(Off "stands", Speed "drives", Gap "follows");
  parameter Mode fallback = Mode.Gap;
  input Mode wanted(start = Mode.Speed);
  input Real u(start = 0.2);
  output Mode mode;
  output Boolean later;
  output Real gain;
  parameter Real gains[Mode] = {1, 20, 300};
equation
  mode = if u > 0.5 then fallback else wanted;
  later = mode > Mode.Off;
  gain = gains[mode];
end EnumerationSignals;
