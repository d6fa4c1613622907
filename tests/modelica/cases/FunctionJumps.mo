// Functions that return from a loop, or leave one of two loops in each other.
model FunctionJumps
  function first "place of the first value beyond a limit; -1 if there is none"
    input Real values[:];
    input Real limit;
    output Real place;
  algorithm
    place := 0;
    for i in 1:size(values, 1) loop
      place := i;
      if values[i] > limit then
        return;
      end if;
    end for;
    place := -1;
    annotation(Inline = false);
  end first;

  function stairs "sums rows while they are small, and ends at a large sum"
    input Real x;
    output Real sum;
    output Real rows;
  protected
    Real row;
  algorithm
    sum := 0;
    rows := 0;
    for i in 1:3 loop
      row := 0;
      for j in 1:3 loop
        row := row + j*x;
        if row > 2*i then
          break;
        elseif sum > 5 then
          return;
        end if;
        sum := sum + 1;
      end for;
      rows := rows + 1;
      sum := sum + row;
    end for;
    sum := -sum;
  end stairs;

  output Real place;
  output Real sum;
  output Real rows;
equation
  place = first({0.2, 0.4, 0.7}, time);
  (sum, rows) = stairs(2*time);
end FunctionJumps;
