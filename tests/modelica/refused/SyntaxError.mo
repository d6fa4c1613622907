model SyntaxError
  output Real y;
equation
  y = 2 * * time; // refused: *
end SyntaxError;
