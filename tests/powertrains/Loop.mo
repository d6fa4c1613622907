package Loop "The loop of the paper: the host with its powertrain, and the vehicle in front"

  model Following "A car with the six-speed automatic behind a vehicle of constant speed"
    extends Combustion.AutomaticCar;
    parameter Real lead_speed(unit = "m/s") = 50/3.6;
    parameter Real initial_gap(unit = "m") = 150;
    parameter Real sight(unit = "m") = 160 "Range of the sensor";
    output Real gap(unit = "m") "From bumper to bumper";
    output Real closing_speed(unit = "m/s");
    output Boolean detected;
  equation
    gap = initial_gap + lead_speed*time - position;
    closing_speed = speed - lead_speed;
    detected = gap < sight;
  end Following;
end Loop;
