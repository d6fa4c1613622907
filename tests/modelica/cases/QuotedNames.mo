// Quoted identifiers, with spaces, operators and brackets in them.
model QuotedNames
  parameter Real 'gain (1)' = 2;
  input Real 'u in'(start = 3);
  output Real 'y+1';
  Real 'a.b';
equation
  'a.b' = 'gain (1)' * 'u in';
  'y+1' = 'a.b' + 1;
end QuotedNames;
