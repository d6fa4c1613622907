// Two nonlinear equations that need each other, coupled with a differential equation; tearing has a choice.
model NonlinearSystem
  Real x(start = 0, fixed = true);
  Real a(start = 1);
  Real b(start = 1);
  Real c;
  output Real y;
  output Real z;
equation
  der(x) = a - x;
  a ^ 2 + b ^ 2 = 4 + x;
  c = a * b;
  c + exp(b - 1) = 2.5 + 0.1 * x;
  y = a;
  z = b;
end NonlinearSystem;
