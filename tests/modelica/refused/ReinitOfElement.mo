model ReinitOfElement
  Real x[2](each start = 0, each fixed = true);
  output Real y = x[1] - x[2];
equation
  der(x) = {1, -1};
  when x[1] > 0.55 then
    reinit(x[1], 0); // refused: 'x[…]', an element of an array
  end when;
end ReinitOfElement;
