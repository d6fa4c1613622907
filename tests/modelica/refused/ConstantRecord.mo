package ConstantRecord
  record Data
    parameter Real k = 1;
  end Data;
  package Values
    constant Data one; // refused: constant 'one', a record
    constant Data five = Data(k = 5), six = Data(k = 6); // refused: constant 'five', a record
    constant Data seven = Data(k = 7);
  end Values;
  model Test
    Data copy = Values.seven;
    output Real y = Values.five.k + Values.one.k + copy.k;
  end Test;
end ConstantRecord;
