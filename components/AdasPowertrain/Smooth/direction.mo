within AdasPowertrain.Smooth;
function direction "Sign of x; about zero a straight line over this width"
  input Real x;
  input Real width "Where it reaches 0.7";
  output Real y;
algorithm
  y := x/sqrt(x*x + width*width);
end direction;
