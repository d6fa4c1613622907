// Discrete equations outside of when that depend on one another and on pre values: a toggle flip-flop chain of two bits.
model DiscreteFeedback
  Boolean clock;
  Boolean bit0(start = false, fixed = true);
  Boolean bit1(start = false, fixed = true);
  output Integer value;
equation
  clock = sin(4 * 3.141592653589793 * time) > 0;
  bit0 = if edge(clock) then not pre(bit0) else pre(bit0);
  bit1 = if pre(bit0) and not bit0 then not pre(bit1) else pre(bit1);
  value = (if bit0 then 1 else 0) + (if bit1 then 2 else 0);
end DiscreteFeedback;
