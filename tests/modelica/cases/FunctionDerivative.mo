// A function inside an equation that has to be differentiated: a wheel whose position is a function of the angle.
model FunctionDerivative
  function cam "lift of a cam"
    input Real phi;
    output Real s;
  algorithm
    s := 0.1 * sin(phi) + 0.02 * phi ^ 2;
    annotation(smoothOrder = 3);
  end cam;
  Real phi(start = 0, fixed = true);
  Real s;
  Real v;
  output Real speed;
  output Real lift;
equation
  der(phi) = 2;
  s = cam(phi);
  v = der(s);
  speed = v;
  lift = s;
end FunctionDerivative;
