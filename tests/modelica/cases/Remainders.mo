// mod, rem and div of negative and positive operands.
model Remainders
  input Real u(start = -2.3);
  output Real m;
  output Real r;
  output Real d;
equation
  m = mod(u + time, 0.75);
  r = rem(u + time, 0.75);
  d = div(u + time, 0.75);
end Remainders;
