// fails: is not in -2147483648
model Overflow
  discrete Integer n(start = 1, fixed = true);
  output Integer y;
equation
  when sample(0.1, 0.1) then
    n = 1000 * pre(n);
  end when;
  y = n;
end Overflow;
