// Integer inputs, outputs and parameters; arithmetic that must stay exact.
model IntegerSignals
  parameter Integer k = 7;
  input Integer n(start = -3);
  output Integer sum;
  output Integer power;
  output Integer bigger;
  output Real half;
equation
  sum = n + k;
  power = n * n * n;
  bigger = max(n, k - 12);
  half = n / 2;
end IntegerSignals;
