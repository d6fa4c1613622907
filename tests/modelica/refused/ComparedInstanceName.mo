model ComparedInstanceName
  final parameter Integer n(fixed = false);
  output Integer y = n;
initial equation
  n = if getInstanceName() == "ComparedInstanceName" then 1 else 2; // refused: getInstanceName
end ComparedInstanceName;
