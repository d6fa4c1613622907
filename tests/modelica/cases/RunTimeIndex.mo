// An array indexed by an integer input and by an expression of it; two dimensions too.
model RunTimeIndex
  parameter Real q[3] = {10, 20, 30};
  parameter Real m[2, 3] = [1, 2, 3; 4, 5, 6];
  input Integer gear(start = 1);
  output Real y;
  output Real z;
  Real ratio[3];
equation
  for i in 1:3 loop
    ratio[i] = q[i] + time;
  end for;
  y = ratio[gear];
  z = m[2, 4 - gear] + m[1, gear];
end RunTimeIndex;
