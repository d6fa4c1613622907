package VehicleInterfaces "Stand-in with the names of the library's interfaces, and buses without members"
  package Interfaces
    expandable connector DriverBus
    end DriverBus;
    expandable connector ControlBus
      DriverBus driverBus;
    end ControlBus;
  end Interfaces;

  package Engines
    model MinimalEngine "50 N.m with the whole pedal, and an inertia"
      Modelica.Mechanics.MultiBody.Interfaces.FlangeWithBearing transmissionFlange;
      VehicleInterfaces.Interfaces.ControlBus controlBus;
      Modelica.Blocks.Interfaces.RealInput pedal;
      Real speed;
    equation
      connect(controlBus.driverBus.acceleratorPedalPosition, pedal);
      speed = der(transmissionFlange.flange.phi);
      transmissionFlange.flange.tau = 0.08*der(speed) - 50*pedal;
    end MinimalEngine;
  end Engines;

  package Transmissions
    model SingleGearAutomaticTransmission
      Modelica.Mechanics.MultiBody.Interfaces.FlangeWithBearing engineFlange;
      Modelica.Mechanics.MultiBody.Interfaces.FlangeWithBearing drivelineFlange;
      VehicleInterfaces.Interfaces.ControlBus controlBus;
    equation
      engineFlange.flange.phi = 4*drivelineFlange.flange.phi;
      4*engineFlange.flange.tau + drivelineFlange.flange.tau = 0;
    end SingleGearAutomaticTransmission;
  end Transmissions;

  package Drivelines
    model MinimalDriveline "Front-wheel drive, both half shafts with a twist"
      Modelica.Mechanics.MultiBody.Interfaces.FlangeWithBearing transmissionFlange;
      Modelica.Mechanics.MultiBody.Interfaces.FlangeWithBearing wheelHub_1;
      Modelica.Mechanics.MultiBody.Interfaces.FlangeWithBearing wheelHub_2;
      Modelica.Mechanics.MultiBody.Interfaces.FlangeWithBearing wheelHub_3;
      Modelica.Mechanics.MultiBody.Interfaces.FlangeWithBearing wheelHub_4;
      VehicleInterfaces.Interfaces.ControlBus controlBus;
      Real side(start = 0, fixed = true) "Angle of the differential";
      Real speed(start = 0, fixed = true);
    equation
      transmissionFlange.flange.phi = 3*side;
      speed = der(side);
      wheelHub_1.flange.tau = -1000*(side - wheelHub_1.flange.phi) - 40*(speed - der(wheelHub_1.flange.phi));
      wheelHub_2.flange.tau = -1000*(side - wheelHub_2.flange.phi) - 40*(speed - der(wheelHub_2.flange.phi));
      3*transmissionFlange.flange.tau + wheelHub_1.flange.tau + wheelHub_2.flange.tau = 0;
      wheelHub_3.flange.tau = 0;
      wheelHub_4.flange.tau = 0;
    end MinimalDriveline;
  end Drivelines;
end VehicleInterfaces;
