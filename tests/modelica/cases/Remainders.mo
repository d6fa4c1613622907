// mod, rem and div of negative and positive operands.
model Remainders
  input Real u(start = -2.3);
  output Real m;
  output Real r;
  output Real d;
  output Real folded;
equation
  m = mod(u + time, 0.75);
  r = rem(u + time, 0.75);
  d = div(u + time, 0.75);
  folded = sum({mod(i + 1, 2.0) + rem(-i, 3.0) + div(-i, 2.0) for i in 1:3});
end Remainders;
