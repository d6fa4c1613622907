package ExternalObjects
  class Table
    extends ExternalObject;
    function constructor
      output Table t;
      external "C" t = open_table();
    end constructor;
    function destructor
      input Table t;
      external "C" close_table(t);
    end destructor;
  end Table;
  function value
    input Table t;
    input Real x;
    output Real y;
    external "C" y = table_value(t, x);
  end value;
  model Test // refused: Table
    Table t = Table();
    output Real y;
  equation
    y = value(t, time);
  end Test;
end ExternalObjects;
