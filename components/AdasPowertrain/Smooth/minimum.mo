within AdasPowertrain.Smooth;
function minimum "The smaller of two; a hyperbola of this width rounds the corner and lies below it by width/2"
  input Real a;
  input Real b;
  input Real width "Over which the corner is rounded";
  output Real y;
algorithm
  y := 0.5*(a + b - sqrt((a - b)*(a - b) + width*width));
end minimum;
