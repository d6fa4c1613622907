// fails: a loop of more than 100 turns
model TooManyTurns
  function turns
    input Real x;
    output Real n = 0;
  algorithm
    while n < x loop
      n := n + 1;
    end while;
  end turns;
  output Real y = turns(300*time);
end TooManyTurns;
