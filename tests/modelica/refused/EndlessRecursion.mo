model EndlessRecursion
  function f
    input Real x;
    output Real y;
  algorithm
    y := x * f(x - 1); // refused: f
  end f;
  output Real y;
equation
  y = f(time);
end EndlessRecursion;
