within AdasPowertrain.Powertrains;
model BatteryElectricThermal
  "As BatteryElectric, with temperatures of machine and battery and a port for the coolant of each. Copper losses and the
   machine's torque limit follow its temperature, as in Parts.ThermalMachine; the battery's resistances follow Arrhenius' law,
   as in Parts.ThermalBattery, and with them what it gives and takes. Heat capacities: 45 kg of steel and copper at 450
   J/(kg.K); cells of 1.07 kg for 78 Ah at 1 kJ/(kg.K)"
  parameter Real ambient(unit="K", min=230, max=330) = 296.15;
  parameter Real initial_temperature(unit="K", min=230, max=350) = 296.15 "Of machine and battery";
  parameter Real machine_capacity(unit="J/K", min=100) = 20e3;
  parameter Real machine_conductance(unit="W/K", min=0) = 5 "To the air";
  parameter Real specific_heat(unit="J/(K.C)", min=1e-4) = 3.81e-3 "Of a cell, per charge";
  parameter Real battery_conductance(unit="W/K", min=0) = 8 "To the air";
  parameter Real activation_energy(unit="J/mol", min=0, max=1e5) = 20e3 "Of the battery's resistances";
  parameter Real derating_temperature(unit="K", min=300, max=500) = 423.15 "The machine's torque limit falls from here …";
  parameter Real highest_temperature(unit="K", min=300, max=500) = 443.15 "… to zero here";
  extends BatteryElectric(
    machine(control(
      copper_factor=(1 + 0.00393 * (machine_body.temperature - 293.15)) / (1 + 0.00393 * (warm - 293.15)),
      derating=noEvent(max(0, min(1, (highest_temperature - machine_body.temperature) / (highest_temperature - derating_temperature)))))),
    battery(
      has_cell_limits=true,
      circuit(resistance_factor=exp(activation_energy / 8.314 * (1 / battery_body.temperature - 1 / 298.15)))));
  constant Real warm(unit="K") = 373.15 "At which the stator has its resistance";
  Interfaces.RealInput machine_heat(unit="W", start=0) "Into the machine";
  Interfaces.RealInput battery_heat(unit="W", start=0) "Into the battery";
  Interfaces.RealOutput machine_temperature(unit="K");
  Interfaces.RealOutput battery_temperature(unit="K");
  Thermal.Body machine_body(heat_capacity=machine_capacity, conductance=machine_conductance, ambient=ambient,
    initial_temperature=initial_temperature, losses=machine.loss);
  Thermal.Body battery_body(heat_capacity=specific_heat * series_cells * capacity, conductance=battery_conductance, ambient=ambient,
    initial_temperature=initial_temperature, losses=battery.circuit.loss);
  Thermal.GivenHeat machine_coolant(power=machine_heat);
  Thermal.GivenHeat battery_coolant(power=battery_heat);
equation
  connect(machine_coolant.heat, machine_body.heat);
  connect(battery_coolant.heat, battery_body.heat);
  machine_temperature = machine_body.temperature;
  battery_temperature = battery_body.temperature;
end BatteryElectricThermal;
