model LeadingOutputSkipped // refused: first result
  function split
    input Real x;
    output Real a;
    output Real b;
  algorithm
    a := 2 * x;
    b := 3 * x;
  end split;
  input Real u(start = 1);
  output Real y;
equation
  (, y) = split(u);
end LeadingOutputSkipped;
