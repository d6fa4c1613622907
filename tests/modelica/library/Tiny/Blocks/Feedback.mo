within Tiny.Blocks;
block Feedback "Output difference between commanded and feedback input"
  Interfaces.RealInput u1;
  Interfaces.RealInput u2;
  Interfaces.RealOutput y;
equation
  y = u1 - u2;
end Feedback;
