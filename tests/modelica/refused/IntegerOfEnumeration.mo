model IntegerOfEnumeration // refused: Enumeration
  type Mode = enumeration(Off, On);
  input Mode mode(start = Mode.Off);
  output Integer y;
equation
  y = Integer(mode);
end IntegerOfEnumeration;
