model UnknownClass
  Engine engine; // refused: Engine
  output Real y;
equation
  y = 1;
end UnknownClass;
