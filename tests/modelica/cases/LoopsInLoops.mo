// A function that returns from a while loop in a for loop, and leaves the inner one by break; its result is an array.
model LoopsInLoops
  function powers "for each base the first power beyond a limit; a base of less than 1.05 ends everything"
    input Real bases[:];
    input Real limit;
    output Real found[size(bases, 1)];
    output Real turns;
  protected
    Real power;
  algorithm
    found := fill(-1, size(bases, 1));
    turns := 0;
    for i in 1:size(bases, 1) loop
      power := 1;
      while power <= limit loop
        if bases[i] < 1.05 then
          return;
        end if;
        power := power * bases[i];
        turns := turns + 1;
        if turns > 12 then
          break;
        end if;
      end while;
      found[i] := power;
    end for;
    turns := -turns;
  end powers;
  output Real first[3];
  output Real turns;
equation
  (first, turns) = powers({3, 2 - time, 1.5}, 4 + 2 * time);
end LoopsInLoops;
