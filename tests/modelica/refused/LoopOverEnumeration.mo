model LoopOverEnumeration
  type Kind = enumeration(first, second);
  output Real y[2];
equation
  for i in Kind loop // refused: a for-equation over 'Kind'
    y[i] = time;
  end for;
end LoopOverEnumeration;
