// Boolean inputs, outputs and parameters, and all operators on them.
model BooleanSignals
  parameter Boolean inverted = false;
  input Boolean a(start = true);
  input Boolean b(start = false);
  output Boolean both;
  output Boolean either;
  output Boolean differ;
  output Boolean ordered;
  output Real y;
equation
  both = a and b;
  either = (a or b) <> inverted;
  differ = a <> b;
  ordered = a == (b or not inverted);
  y = if both then 3 elseif differ then 2 else 1;
end BooleanSignals;
