model WhenForElements
  output Integer k[3](start = {1, 2, 3}, each fixed = true);
equation
  for i in 1:3 loop
    when time > 0.25 * i then
      k[i] = pre(k[i]) * 10; // refused: 'k[…]', an element of an array
    end when;
  end for;
end WhenForElements;
