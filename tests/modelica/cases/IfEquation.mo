// if-equations with several equations a branch, with a derivative, and with a parameter as condition.
model IfEquation
  parameter Boolean upside = false;
  Real x(start = 1, fixed = true);
  Real a;
  Real b;
  output Real y;
  output Real z;
equation
  if x > 0.5 then
    der(x) = -1;
    a = 2 * b;
    b = x;
  elseif time > 1.2 then
    der(x) = 2 - 4 * x;
    b = 7 - a;
    a = 3 * x;
  else
    a = 1;
    der(x) = -x;
    b = 2;
  end if;
  if upside then
    z = -x;
  else
    z = x;
  end if;
  y = a + b;
end IfEquation;
