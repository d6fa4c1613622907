partial model PartialModel // refused: partial
  output Real y;
equation
  y = time;
end PartialModel;
