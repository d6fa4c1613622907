// Functions that take the place of those of the Modelica Standard Library whose C code is not part of dse.
//
// Tables: smooth ones, and a point outside of a table without extrapolation, give no number (NaN), which ends the run.
// Constant segments are continued by straight lines, as by the library. Of a table over the time, the segment is the
// one before the next event, so that it changes at events only.
package LibraryFunctions
  import Modelica.Blocks.Types.{Extrapolation, Smoothness};

  function getTable1DValue
    input Real table[:, :]; input Integer columns[:]; input Smoothness smoothness; input Extrapolation extrapolation;
    input Integer icol; input Real u; output Real y;
    protected Integer n = size(table, 1); Real x; Real z;
  algorithm
    x := u;
    z := x;
    y := sqrt(-1 - abs(z));
  end getTable1DValue;

  function getTable1DValueNoDer
    input Real table[:, :]; input Integer columns[:]; input Smoothness smoothness; input Extrapolation extrapolation;
    input Integer icol; input Real u; output Real y;
    protected Integer n = size(table, 1); Real x; Real z;
  algorithm
    x := u;
    z := if extrapolation == Extrapolation.Periodic then x - (if n > 1 then floor((x - table[1, 1])/(table[n, 1] -
      table[1, 1]))*(table[n, 1] - table[1, 1]) else 0) elseif x >= table[1, 1] and x <= table[n, 1] then x elseif
      extrapolation == Extrapolation.HoldLastPoint then (if x < table[1, 1] then table[1, 1] else table[n, 1]) elseif
      extrapolation == Extrapolation.LastTwoPoints then x else sqrt(-1 - abs(x));
    y := table[1, columns[icol]];
    for j in 2:n loop
      y := if z >= table[j, 1] then table[j, columns[icol]] else y;
    end for;
    for j in 1:n - 1 loop
      y := if extrapolation == Extrapolation.LastTwoPoints and (j == 1 and x < table[1, 1] or j == n - 1 and x >
        table[n, 1]) then table[j, columns[icol]] + (if table[j + 1, 1] > table[j, 1] then (z - table[j, 1])*(table[j
        + 1, columns[icol]] - table[j, columns[icol]])/(table[j + 1, 1] - table[j, 1]) elseif j == n - 1 and z >=
        table[j, 1] then table[j + 1, columns[icol]] - table[j, columns[icol]] else 0) else y;
    end for;
  end getTable1DValueNoDer;

  function getTable1DValueNoDer2
    input Real table[:, :]; input Integer columns[:]; input Smoothness smoothness; input Extrapolation extrapolation;
    input Integer icol; input Real u; output Real y;
    protected Integer n = size(table, 1); Real x; Real z;
  algorithm
    x := u;
    z := if extrapolation == Extrapolation.Periodic then x - (if n > 1 then floor((x - table[1, 1])/(table[n, 1] -
      table[1, 1]))*(table[n, 1] - table[1, 1]) else 0) elseif x >= table[1, 1] and x <= table[n, 1] then x elseif
      extrapolation == Extrapolation.HoldLastPoint then (if x < table[1, 1] then table[1, 1] else table[n, 1]) elseif
      extrapolation == Extrapolation.LastTwoPoints then x else sqrt(-1 - abs(x));
    y := table[1, columns[icol]];
    for j in 1:n - 1 loop
      y := if j == 1 or z >= table[j, 1] then table[j, columns[icol]] + (if table[j + 1, 1] > table[j, 1] then (z -
        table[j, 1])*(table[j + 1, columns[icol]] - table[j, columns[icol]])/(table[j + 1, 1] - table[j, 1]) elseif j
        == n - 1 and z >= table[j, 1] then table[j + 1, columns[icol]] - table[j, columns[icol]] else 0) else y;
    end for;
  end getTable1DValueNoDer2;

  function getTable1DAbscissaUmin
    input Real table[:, :]; input Integer columns[:]; input Smoothness smoothness; input Extrapolation extrapolation;
    output Real uMin;
  algorithm
    uMin := table[1, 1];
  end getTable1DAbscissaUmin;

  function getTable1DAbscissaUmax
    input Real table[:, :]; input Integer columns[:]; input Smoothness smoothness; input Extrapolation extrapolation;
    output Real uMax;
  algorithm
    uMax := table[size(table, 1), 1];
  end getTable1DAbscissaUmax;

  function getTable2DValue
    input Real table[:, :]; input Smoothness smoothness; input Extrapolation extrapolation; input Real u1; input Real
    u2; output Real y;
    protected Integer m = size(table, 1); Integer n = size(table, 2); Integer i; Integer k; Real z1; Real z2;
  algorithm
    i := 0;
    k := 0;
    z1 := u1;
    z2 := u2;
    y := sqrt(-1 - abs(u1));
  end getTable2DValue;

  function getTable2DValueNoDer
    input Real table[:, :]; input Smoothness smoothness; input Extrapolation extrapolation; input Real u1; input Real
    u2; output Real y;
    protected Integer m = size(table, 1); Integer n = size(table, 2); Integer i; Integer k; Real z1; Real z2;
  algorithm
    z1 := if extrapolation == Extrapolation.Periodic then u1 - floor((u1 - table[2, 1])/(table[m, 1] - table[2,
      1]))*(table[m, 1] - table[2, 1]) elseif u1 >= table[2, 1] and u1 <= table[m, 1] then u1 elseif extrapolation ==
      Extrapolation.LastTwoPoints then u1 elseif extrapolation == Extrapolation.HoldLastPoint then (if u1 < table[2,
      1] then table[2, 1] else table[m, 1]) else sqrt(-1 - abs(u1));
    z2 := if extrapolation == Extrapolation.Periodic then u2 - floor((u2 - table[1, 2])/(table[1, n] - table[1,
      2]))*(table[1, n] - table[1, 2]) elseif u2 >= table[1, 2] and u2 <= table[1, n] then u2 elseif extrapolation ==
      Extrapolation.LastTwoPoints then u2 elseif extrapolation == Extrapolation.HoldLastPoint then (if u2 < table[1,
      2] then table[1, 2] else table[1, n]) else sqrt(-1 - abs(u2));
    i := 2;
    k := 2;
    y := getTable2DLines(z1, z2, table[2:m, 1], table[1, 2:n], table[2:m, 2:n]);
    for j in 3:m loop
      i := if z1 >= table[j, 1] then j else i;
    end for;
    for j in 3:n loop
      k := if z2 >= table[1, j] then j else k;
    end for;
    y := if z1 < table[2, 1] or z1 > table[m, 1] or z2 < table[1, 2] or z2 > table[1, n] then y else table[i, k];
  end getTable2DValueNoDer;

  function getTable2DValueNoDer2
    input Real table[:, :]; input Smoothness smoothness; input Extrapolation extrapolation; input Real u1; input Real
    u2; output Real y;
    protected Integer m = size(table, 1); Integer n = size(table, 2); Integer i; Integer k; Real z1; Real z2;
  algorithm
    z1 := if extrapolation == Extrapolation.Periodic then u1 - floor((u1 - table[2, 1])/(table[m, 1] - table[2,
      1]))*(table[m, 1] - table[2, 1]) elseif u1 >= table[2, 1] and u1 <= table[m, 1] then u1 elseif extrapolation ==
      Extrapolation.LastTwoPoints then u1 elseif extrapolation == Extrapolation.HoldLastPoint then (if u1 < table[2,
      1] then table[2, 1] else table[m, 1]) else sqrt(-1 - abs(u1));
    z2 := if extrapolation == Extrapolation.Periodic then u2 - floor((u2 - table[1, 2])/(table[1, n] - table[1,
      2]))*(table[1, n] - table[1, 2]) elseif u2 >= table[1, 2] and u2 <= table[1, n] then u2 elseif extrapolation ==
      Extrapolation.LastTwoPoints then u2 elseif extrapolation == Extrapolation.HoldLastPoint then (if u2 < table[1,
      2] then table[1, 2] else table[1, n]) else sqrt(-1 - abs(u2));
    i := 2;
    k := 2;
    y := getTable2DLines(z1, z2, table[2:m, 1], table[1, 2:n], table[2:m, 2:n]);
  end getTable2DValueNoDer2;

  function getTable2DLines
    input Real x; input Real y; input Real xs[:]; input Real ys[:]; input Real zs[size(xs, 1), size(ys, 1)]; output
    Real z;
    external "C" z = dse_table2(x, y, xs, size(xs, 1), ys, size(ys, 1), zs, 0, 2);
  end getTable2DLines;

  function getTable2DAbscissaUmin
    input Real table[:, :]; input Smoothness smoothness; input Extrapolation extrapolation; output Real uMin[2];
  algorithm
    uMin := {table[2, 1], table[1, 2]};
  end getTable2DAbscissaUmin;

  function getTable2DAbscissaUmax
    input Real table[:, :]; input Smoothness smoothness; input Extrapolation extrapolation; output Real uMax[2];
  algorithm
    uMax := {table[size(table, 1), 1], table[1, size(table, 2)]};
  end getTable2DAbscissaUmax;

  function getTimeTableValue
    input Real table[:, :]; input Integer columns[:]; input Smoothness smoothness; input Extrapolation extrapolation;
    input Real startTime; input Real shiftTime; input Integer icol; input Real timeIn; input Real nextTimeEvent; input
    Real pre_nextTimeEvent; output Real y;
    protected Integer n = size(table, 1); Real x; Real z; Real k;
  algorithm
    x := timeIn - shiftTime;
    k := nextTimeEvent - shiftTime;
    z := x;
    y := sqrt(-1 - abs(z + k));
    y := if nextTimeEvent <= startTime then 0 else y;
  end getTimeTableValue;

  function getTimeTableValueNoDer
    input Real table[:, :]; input Integer columns[:]; input Smoothness smoothness; input Extrapolation extrapolation;
    input Real startTime; input Real shiftTime; input Integer icol; input Real timeIn; input Real nextTimeEvent; input
    Real pre_nextTimeEvent; output Real y;
    protected Integer n = size(table, 1); Real x; Real z; Real k;
  algorithm
    x := timeIn - shiftTime;
    k := nextTimeEvent - shiftTime;
    k := if extrapolation == Extrapolation.Periodic and n > 1 then k - (ceil((k - table[n, 1])/(table[n, 1] - table[1,
      1]) - 1e-9))*(table[n, 1] - table[1, 1]) else k;
    x := if extrapolation == Extrapolation.Periodic and n > 1 then x - nextTimeEvent + shiftTime + k else x;
    z := if extrapolation == Extrapolation.HoldLastPoint then (if k <= table[1, 1] then table[1, 1] elseif k >
      table[n, 1] then table[n, 1] else x) elseif extrapolation == Extrapolation.NoExtrapolation and (k <= table[1, 1]
      or x > table[n, 1]) then sqrt(-1 - abs(x)) else x;
    y := table[1, columns[icol]];
    for j in 2:n loop
      y := if k > table[j, 1] + 1e-10*(1 + abs(k)) then table[j, columns[icol]] else y;
    end for;
    for j in 1:n - 1 loop
      y := if extrapolation == Extrapolation.LastTwoPoints and (j == 1 and k <= table[1, 1] or j == n - 1 and k >
        table[n, 1] + 1e-10*(1 + abs(k))) then table[j, columns[icol]] + (if table[j + 1, 1] > table[j, 1] then (z -
        table[j, 1])*(table[j + 1, columns[icol]] - table[j, columns[icol]])/(table[j + 1, 1] - table[j, 1]) elseif j
        == n - 1 and z >= table[j, 1] then table[j + 1, columns[icol]] - table[j, columns[icol]] else 0) else y;
    end for;
    y := if nextTimeEvent <= startTime then 0 else y;
  end getTimeTableValueNoDer;

  function getTimeTableValueNoDer2
    input Real table[:, :]; input Integer columns[:]; input Smoothness smoothness; input Extrapolation extrapolation;
    input Real startTime; input Real shiftTime; input Integer icol; input Real timeIn; input Real nextTimeEvent; input
    Real pre_nextTimeEvent; output Real y;
    protected Integer n = size(table, 1); Real x; Real z; Real k;
  algorithm
    x := timeIn - shiftTime;
    k := nextTimeEvent - shiftTime;
    k := if extrapolation == Extrapolation.Periodic and n > 1 then k - (ceil((k - table[n, 1])/(table[n, 1] - table[1,
      1]) - 1e-9))*(table[n, 1] - table[1, 1]) else k;
    x := if extrapolation == Extrapolation.Periodic and n > 1 then x - nextTimeEvent + shiftTime + k else x;
    z := if extrapolation == Extrapolation.HoldLastPoint then (if k <= table[1, 1] then table[1, 1] elseif k >
      table[n, 1] then table[n, 1] else x) elseif extrapolation == Extrapolation.NoExtrapolation and (k <= table[1, 1]
      or x > table[n, 1]) then sqrt(-1 - abs(x)) else x;
    y := table[1, columns[icol]];
    for j in 1:n - 1 loop
      y := if j == 1 or k > table[j, 1] + 1e-10*(1 + abs(k)) then table[j, columns[icol]] + (if table[j + 1, 1] >
        table[j, 1] then (z - table[j, 1])*(table[j + 1, columns[icol]] - table[j, columns[icol]])/(table[j + 1, 1] -
        table[j, 1]) elseif j == n - 1 and z >= table[j, 1] then table[j + 1, columns[icol]] - table[j, columns[icol]]
        else 0) else y;
    end for;
    y := if nextTimeEvent <= startTime then 0 else y;
  end getTimeTableValueNoDer2;

  function getTimeTableTmin
    input Real table[:, :]; input Integer columns[:]; input Smoothness smoothness; input Extrapolation extrapolation;
    input Real startTime; input Real shiftTime; output Real timeMin;
  algorithm
    timeMin := table[1, 1];
  end getTimeTableTmin;

  function getTimeTableTmax
    input Real table[:, :]; input Integer columns[:]; input Smoothness smoothness; input Extrapolation extrapolation;
    input Real startTime; input Real shiftTime; output Real timeMax;
  algorithm
    timeMax := table[size(table, 1), 1];
  end getTimeTableTmax;

  function getNextTimeEvent
    input Real table[:, :]; input Integer columns[:]; input Smoothness smoothness; input Extrapolation extrapolation;
    input Real startTime; input Real shiftTime; input Real timeIn; output Real nextTimeEvent;
    protected Integer n = size(table, 1); Real x; Real y; Real base;
  algorithm
    x := timeIn - shiftTime + 1e-10*(1 + abs(timeIn));
    base := if extrapolation == Extrapolation.Periodic and n > 1 then floor((x - table[1, 1])/(table[n, 1] - table[1,
      1]))*(table[n, 1] - table[1, 1]) else 0;
    y := 1e60;
    for j in 1:n loop
      y := if y > 1e59 and table[j, 1] + base > x then table[j, 1] + base else y;
    end for;
    y := if y > 1e59 then 1e60 else y + shiftTime;
    nextTimeEvent := if startTime > x + shiftTime and startTime < y then startTime else y;
  end getNextTimeEvent;

  function random
    input Integer stateIn[nState]; output Real result; output Integer stateOut[nState];
  algorithm
    result := dse_draw(stateIn, 0);
    stateOut := dse_next(stateIn);
  end random;

  function dse_next
    input Integer stateIn[nState]; output Integer stateOut[nState];
  algorithm
    for i in 1:nState loop
      stateOut[i] := dse_step(stateIn, i);
    end for;
  end dse_next;

  pure function dse_draw
    input Integer stateIn[:]; input Integer which; output Real y;
    external "C" y = dse_random(stateIn, size(stateIn, 1), which);
  end dse_draw;

  pure function dse_step
    input Integer stateIn[:]; input Integer which; output Integer y;
    external "C" y = dse_random(stateIn, size(stateIn, 1), which);
  end dse_step;

  function initialState
    input Integer localSeed; input Integer globalSeed; output Integer state[nState];
  algorithm
    for i in 1:nState loop
      state[i] := dse_start(localSeed, globalSeed, i);
    end for;
  end initialState;

  pure function dse_start
    input Integer localSeed; input Integer globalSeed; input Integer which; output Integer y;
    external "C" y = dse_random_start(localSeed, globalSeed, which);
  end dse_start;

  function automaticGlobalSeed
    output Integer seed;
  algorithm
    assert(false, "a seed by the clock is not reproducible: set useAutomaticSeed = false, and fixedSeed");
    seed := 1;
  end automaticGlobalSeed;

  function initializeImpureRandom
    input Integer seed; output Integer id;
  algorithm
    id := seed;
  end initializeImpureRandom;
end LibraryFunctions;
