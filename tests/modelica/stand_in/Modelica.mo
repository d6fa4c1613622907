package Modelica "Stand-in for what the template of VehicleInterfaces names in the Standard Library"
  package Blocks
    package Interfaces
      connector RealOutput = output Real;
      connector RealInput = input Real;
    end Interfaces;
  end Blocks;
  package Mechanics
    package Rotational
      package Interfaces
        connector Flange_a
          Real phi;
          flow Real tau;
        end Flange_a;
      end Interfaces;
    end Rotational;
    package MultiBody
      model World
        parameter Boolean enableAnimation = true;
        parameter Boolean driveTrainMechanics3D = true;
      end World;
      package Interfaces
        connector FlangeWithBearing
          Modelica.Mechanics.Rotational.Interfaces.Flange_a flange;
        end FlangeWithBearing;
      end Interfaces;
    end MultiBody;
  end Mechanics;
end Modelica;
