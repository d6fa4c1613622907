package Modelica "Stands for the Modelica Standard Library: the declarations of its tables, without their C code"
  package Blocks
    package Types
      type Smoothness = enumeration(LinearSegments, ContinuousDerivative, ConstantSegments);
      type Extrapolation = enumeration(HoldLastPoint, LastTwoPoints, Periodic, NoExtrapolation);
      class ExternalCombiTable1D
        extends ExternalObject;
        function constructor
          input String tableName;
          input String fileName;
          input Real table[:, :];
          input Integer columns[:];
          input Smoothness smoothness;
          input Extrapolation extrapolation = Extrapolation.LastTwoPoints;
          output ExternalCombiTable1D object;
          external "C" object = absent(tableName, fileName, table);
        end constructor;
        function destructor
          input ExternalCombiTable1D object;
          external "C" absent(object);
        end destructor;
      end ExternalCombiTable1D;
      class ExternalCombiTable2D
        extends ExternalObject;
        function constructor
          input String tableName;
          input String fileName;
          input Real table[:, :];
          input Smoothness smoothness;
          input Extrapolation extrapolation = Extrapolation.LastTwoPoints;
          output ExternalCombiTable2D object;
          external "C" object = absent(tableName, fileName, table);
        end constructor;
        function destructor
          input ExternalCombiTable2D object;
          external "C" absent(object);
        end destructor;
      end ExternalCombiTable2D;
      class ExternalCombiTimeTable
        extends ExternalObject;
        function constructor
          input String tableName;
          input String fileName;
          input Real table[:, :];
          input Real startTime;
          input Integer columns[:];
          input Smoothness smoothness;
          input Extrapolation extrapolation;
          input Real shiftTime = 0;
          output ExternalCombiTimeTable object;
          external "C" object = absent(tableName, fileName, table);
        end constructor;
        function destructor
          input ExternalCombiTimeTable object;
          external "C" absent(object);
        end destructor;
      end ExternalCombiTimeTable;
    end Types;
    package Tables
      block Curve "A table over an input"
        parameter Real table[:, :] = fill(0.0, 0, 2);
        parameter Integer columns[:] = 2:size(table, 2);
        parameter Types.Smoothness smoothness = Types.Smoothness.LinearSegments;
        parameter Types.Extrapolation extrapolation = Types.Extrapolation.LastTwoPoints;
        final parameter Real first = Internal.getTable1DAbscissaUmin(tableID);
        final parameter Real last = Internal.getTable1DAbscissaUmax(tableID);
        input Real u;
        output Real y;
      protected
        parameter Types.ExternalCombiTable1D tableID = Types.ExternalCombiTable1D("NoName", "NoName", table, columns,
          smoothness, extrapolation) "External; object (";
      equation
        y = if smoothness == Types.Smoothness.ConstantSegments then Internal.getTable1DValueNoDer(tableID, 1, u)
          elseif smoothness == Types.Smoothness.LinearSegments then Internal.getTable1DValueNoDer2(tableID, 1, u)
          else Internal.getTable1DValue(tableID, 1, u);
      end Curve;
      partial block Grid "The declaration of a table over two inputs"
        parameter Real table[:, :] = fill(0.0, 0, 2);
        parameter Types.Smoothness smoothness = Types.Smoothness.LinearSegments;
        parameter Types.Extrapolation extrapolation = Types.Extrapolation.LastTwoPoints;
        final parameter Real first[2] = Internal.getTable2DAbscissaUmin(tableID);
        final parameter Real last[2] = Internal.getTable2DAbscissaUmax(tableID);
      protected
        parameter Types.ExternalCombiTable2D tableID = Types.ExternalCombiTable2D("NoName", "NoName", table,
          smoothness, extrapolation);
      end Grid;
      block Surface "A table over two inputs, declared in the class that it extends"
        extends Tables.Grid;
        input Real u1;
        input Real u2;
        output Real y;
      equation
        y = if smoothness == Types.Smoothness.ConstantSegments then Internal.getTable2DValueNoDer(tableID, u1, u2)
          elseif smoothness == Types.Smoothness.LinearSegments then Internal.getTable2DValueNoDer2(tableID, u1, u2)
          else Internal.getTable2DValue(tableID, u1, u2);
      end Surface;
      block Friction "A number of a table in a parameter"
        extends Icons.Friction;
        import Modelica.Blocks.Types.{ExternalCombiTable1D, Extrapolation, Smoothness};
        import Modelica.Blocks.Tables.Internal.getTable1DValueNoDer2;
        parameter Real mu_pos[:, 2] = [0, 0.5];
        final parameter ExternalCombiTable1D tableID = ExternalCombiTable1D(tableName = "NoName", fileName = "NoName",
          table = mu_pos, columns = {2}, smoothness = Smoothness.LinearSegments) "Object";
        final parameter Real mu0 = getTable1DValueNoDer2(tableID, 1, 0);
      end Friction;
      package Icons
        partial block Friction "Of the same name as the block"
        end Friction;
      end Icons;
      package Internal
        pure function getTable1DValue
          input Types.ExternalCombiTable1D tableID;
          input Integer icol;
          input Real u;
          output Real y;
          external "C" y = absent(tableID, icol, u);
        end getTable1DValue;
        pure function getTable1DValueNoDer
          input Types.ExternalCombiTable1D tableID;
          input Integer icol;
          input Real u;
          output Real y;
          external "C" y = absent(tableID, icol, u);
        end getTable1DValueNoDer;
        pure function getTable1DValueNoDer2
          input Types.ExternalCombiTable1D tableID;
          input Integer icol;
          input Real u;
          output Real y;
          external "C" y = absent(tableID, icol, u);
        end getTable1DValueNoDer2;
        pure function getTable1DAbscissaUmin
          input Types.ExternalCombiTable1D tableID;
          output Real uMin;
          external "C" uMin = absent(tableID);
        end getTable1DAbscissaUmin;
        pure function getTable1DAbscissaUmax
          input Types.ExternalCombiTable1D tableID;
          output Real uMax;
          external "C" uMax = absent(tableID);
        end getTable1DAbscissaUmax;
        pure function getTable2DValue
          input Types.ExternalCombiTable2D tableID;
          input Real u1;
          input Real u2;
          output Real y;
          external "C" y = absent(tableID, u1, u2);
        end getTable2DValue;
        pure function getTable2DValueNoDer
          input Types.ExternalCombiTable2D tableID;
          input Real u1;
          input Real u2;
          output Real y;
          external "C" y = absent(tableID, u1, u2);
        end getTable2DValueNoDer;
        pure function getTable2DValueNoDer2
          input Types.ExternalCombiTable2D tableID;
          input Real u1;
          input Real u2;
          output Real y;
          external "C" y = absent(tableID, u1, u2);
        end getTable2DValueNoDer2;
        pure function getTable2DAbscissaUmin
          input Types.ExternalCombiTable2D tableID;
          output Real u[2];
          external "C" absent(tableID, u);
        end getTable2DAbscissaUmin;
        pure function getTable2DAbscissaUmax
          input Types.ExternalCombiTable2D tableID;
          output Real u[2];
          external "C" absent(tableID, u);
        end getTable2DAbscissaUmax;
        pure function getTimeTableValueNoDer
          input Types.ExternalCombiTimeTable tableID;
          input Integer icol;
          input Real timeIn;
          input Real nextTimeEvent;
          input Real pre_nextTimeEvent;
          output Real y;
          external "C" y = absent(tableID, icol, timeIn, nextTimeEvent, pre_nextTimeEvent);
        end getTimeTableValueNoDer;
        pure function getTimeTableValueNoDer2
          input Types.ExternalCombiTimeTable tableID;
          input Integer icol;
          input Real timeIn;
          input Real nextTimeEvent;
          input Real pre_nextTimeEvent;
          output Real y;
          external "C" y = absent(tableID, icol, timeIn, nextTimeEvent, pre_nextTimeEvent);
        end getTimeTableValueNoDer2;
        pure function getNextTimeEvent
          input Types.ExternalCombiTimeTable tableID;
          input Real timeIn;
          output Real nextTimeEvent;
          external "C" nextTimeEvent = absent(tableID, timeIn);
        end getNextTimeEvent;
      end Internal;
    end Tables;
    package Sources
      block Course "A table over the time"
        parameter Real table[:, :] = fill(0.0, 0, 2);
        parameter Types.Smoothness smoothness = Types.Smoothness.LinearSegments;
        parameter Types.Extrapolation extrapolation = Types.Extrapolation.LastTwoPoints;
        parameter Real startTime = -1e3;
        parameter Real shiftTime = 0;
        output Real y;
      protected
        discrete Real next(start = 0, fixed = true);
        parameter Types.ExternalCombiTimeTable tableID = Types.ExternalCombiTimeTable("NoName", "NoName", table,
          startTime, {2}, smoothness, extrapolation, shiftTime);
      equation
        when {time >= pre(next), initial()} then
          next = Tables.Internal.getNextTimeEvent(tableID, time);
        end when;
        y = if smoothness == Types.Smoothness.ConstantSegments
          then Tables.Internal.getTimeTableValueNoDer(tableID, 1, time, next, pre(next))
          else Tables.Internal.getTimeTableValueNoDer2(tableID, 1, time, next, pre(next));
      end Course;
    end Sources;
  end Blocks;
end Modelica;
