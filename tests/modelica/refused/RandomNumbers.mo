model RandomNumbers // refused: random
  impure function random
    output Real y;
    external "C" y = rand();
  end random;
  output Real y;
equation
  y = random();
end RandomNumbers;
