// fails: index
model IndexOutside
  parameter Real q[3] = {1, 2, 3};
  Integer k;
  output Real y;
equation
  k = if time < 0.5 then 1 else 4;
  y = q[k];
end IndexOutside;
