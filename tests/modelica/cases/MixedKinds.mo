// Integers, Booleans and reals converted into each other, in equations and in events.
model MixedKinds
  type Side = enumeration(Left, Right);
  parameter Integer n = 3;
  parameter Side side = Side.Right;
  discrete Integer count(start = 2, fixed = true);
  Real x(start = 0, fixed = true);
  output Real y;
  output Real z;
  output Integer whole;
  output Boolean is_big;
equation
  der(x) = count / n;
  when {x > 0.4, x > 0.8} then
    count = pre(count) * n - integer(10 * x + 0.5);
  end when;
  y = x * n + count;
  z = if side == Side.Right then -x else x;
  whole = if count > 2 then n - count else count + n;
  is_big = count >= 2 and n > 2 or side == Side.Left;
end MixedKinds;
