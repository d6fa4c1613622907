// A motion of which the model is given position, speed and acceleration: they are not differentiated, but taken.
model NoDerivative
  function position
    input Real motion[3] "position, speed, acceleration";
    input Real t "to differentiate by";
    output Real s;
  algorithm
    s := motion[1];
    annotation(derivative(noDerivative = motion) = speed);
  end position;
  function speed
    input Real motion[3];
    input Real t;
    input Real t_rate;
    output Real v;
  algorithm
    v := motion[2];
    annotation(derivative(noDerivative = motion, order = 2) = acceleration);
  end speed;
  function acceleration
    input Real motion[3];
    input Real t;
    input Real t_rate;
    input Real t_rate2;
    output Real a;
  algorithm
    a := motion[3];
  end acceleration;
  parameter Real m = 2;
  input Real motion[3](start = {1, 0, 0});
  Real s;
  Real v;
  Real x(start = 1, fixed = true);
  Real w;
  Real copy;
  output Real place;
  output Real force;
  output Real copied_speed;
equation
  s = position(motion, time);
  v = der(s);
  m * der(v) = force;
  place = s;
  w = der(x);
  w = -x;
  copy = position({x, w, x}, time) "its speed is an unknown of the model";
  copied_speed = der(copy);
end NoDerivative;
