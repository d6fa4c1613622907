model ValuesOfEnumeration // refused: expected Integer, found Enumeration
  type Kind = enumeration(first, second);
  output Real y[2];
equation
  for i in Kind loop
    y[i] = if i == Kind.first then time else 0;
  end for;
end ValuesOfEnumeration;
