package Electric "Electric drives of the library in a small car: test models, compared with independent references"


  model Car "Road loads on rigid wheels; a brake takes what the powertrain does not"
    parameter Real mass = 1880;
    parameter Real wheel_radius = 0.335;
    parameter Real drag_area = 0.63;
    parameter Real air_density = 1.2;
    parameter Real rolling_resistance = 0.009;
    parameter Real initial_speed = 0;
    Real drive_torque;
    Real brake_torque;
    Real wheel_speed;
    Real speed(start=initial_speed, fixed=true);
    Real distance(start=0, fixed=true);
  equation
    wheel_speed = speed / wheel_radius;
    der(distance) = speed;
    mass * der(speed) = (drive_torque - brake_torque) / wheel_radius - rolling_resistance * mass * 9.81 * tanh(speed / 0.1)
      - 0.5 * air_density * drag_area * speed * abs(speed);
  end Car;

  model Driver "Torque over time: away, full load, cruise, recuperation, cruise"
    output Real torque_demand;
  equation
    torque_demand = if time < 0.5 then 0 elseif time < 3 then 1200 elseif time < 14 then 4000 elseif time < 18 then 300 elseif time < 26 then -2500 else 100;
  end Driver;

  partial model InCar "A powertrain and its car"
    Real torque_demand;
    replaceable AdasPowertrain.Interfaces.Powertrain powertrain;
    Car car;
    output Real speed = car.speed;
    output Real soc;
  equation
    powertrain.torque_demand = torque_demand;
    powertrain.wheel_speed_front = car.wheel_speed;
    powertrain.wheel_speed_rear = car.wheel_speed;
    car.drive_torque = powertrain.torque_front + powertrain.torque_rear;
  end InCar;

  model BatteryElectricInCar
    extends InCar(redeclare AdasPowertrain.Powertrains.BatteryElectric powertrain);
    Driver driver;
  equation
    soc = powertrain.soc;
    torque_demand = driver.torque_demand;
    car.brake_torque = 0;
  end BatteryElectricInCar;

  model ThermalElectricInCar "On a coolant circuit with a radiator; where the heat of machine and battery goes"
    parameter Real cold = 293.15;
    AdasPowertrain.Powertrains.BatteryElectricThermal powertrain(initial_temperature=cold, ambient=cold);
    AdasPowertrain.Parts.CoolantCircuit coolant(circuit(initial_temperature=cold, ambient=cold));
    Car car;
    Driver driver;
    output Real speed = car.speed;
    output Real soc = powertrain.soc;
    output Real heat(start=0, fixed=true) "Of machine and battery";
    output Real air(start=0, fixed=true);
    output Real machine_kelvin = powertrain.machine_temperature;
    output Real battery_kelvin = powertrain.battery_temperature;
    output Real coolant_kelvin = coolant.temperature;
  equation
    powertrain.torque_demand = driver.torque_demand;
    powertrain.wheel_speed_front = car.wheel_speed;
    powertrain.wheel_speed_rear = car.wheel_speed;
    car.drive_torque = powertrain.torque_front + powertrain.torque_rear;
    car.brake_torque = 0;
    coolant.engine_temperature = cold;
    coolant.machine_temperature = powertrain.machine_temperature;
    coolant.battery_temperature = powertrain.battery_temperature;
    powertrain.machine_heat = coolant.machine_heat;
    powertrain.battery_heat = coolant.battery_heat;
    der(heat) = powertrain.machine.loss + powertrain.battery.circuit.loss;
    der(air) = 5*(machine_kelvin - cold) + 8*(battery_kelvin - cold) + 250*noEvent(max(0, min(1, (coolant_kelvin - 298.15)/5)))*(coolant_kelvin - cold);
  end ThermalElectricInCar;

  model QuasiStaticInCar
    extends InCar(redeclare AdasPowertrain.Powertrains.BatteryElectricQuasiStatic powertrain);
    Driver driver;
  equation
    soc = powertrain.soc;
    torque_demand = driver.torque_demand;
    car.brake_torque = 0;
  end QuasiStaticInCar;

  model BatteryElectricOnCycle
    extends InCar(redeclare AdasPowertrain.Powertrains.BatteryElectric powertrain);
    extends Chase(mass=1880, wheel_radius=0.335, drag_area=0.63);
  equation
    soc = powertrain.soc;
    torque_demand = wanted;
    car.brake_torque = brake;
    actual = car.speed;
    delivered = car.drive_torque;
  end BatteryElectricOnCycle;

  model QuasiStaticOnCycle
    extends InCar(redeclare AdasPowertrain.Powertrains.BatteryElectricQuasiStatic powertrain);
    extends Chase(mass=1880, wheel_radius=0.335, drag_area=0.63);
  equation
    soc = powertrain.soc;
    torque_demand = wanted;
    car.brake_torque = brake;
    actual = car.speed;
    delivered = car.drive_torque;
  end QuasiStaticOnCycle;

  partial model RangeExtenderParts "The parts of the range extender, coupled without delay"
    Real torque_demand;
    Car car(mass=1500, wheel_radius=0.34, drag_area=0.70);
    AdasPowertrain.Parts.Machine machine;
    AdasPowertrain.Parts.Battery battery;
    AdasPowertrain.Parts.GeneratorSet generator;
    AdasPowertrain.Parts.SeriesControl control;
    AdasPowertrain.Parts.SingleSpeedAxle axle;
    output Real speed = car.speed;
    output Real soc = battery.soc;
    output Real energy_in = battery.energy_in + generator.energy_in;
    output Real energy_out = axle.energy_out;
    output Real energy_loss = battery.energy_loss + generator.energy_loss + machine.energy_loss + axle.energy_loss;
    output Real energy_stored = battery.energy_stored + generator.energy_stored + axle.energy_stored;
  equation
    control.torque_demand = torque_demand;
    control.motor_speed = axle.machine_speed;
    control.soc = battery.soc;
    machine.torque_demand = control.machine_torque_demand;
    machine.shaft_speed = axle.machine_speed;
    machine.voltage = battery.voltage;
    generator.power_demand = control.generator_power_demand;
    battery.electric_power = machine.electric_power;
    battery.charging_power = generator.electric_power;
    axle.machine_torque = machine.torque;
    axle.wheel_speed_front = car.wheel_speed;
    axle.wheel_speed_rear = car.wheel_speed;
    car.drive_torque = axle.torque_front + axle.torque_rear;
  end RangeExtenderParts;

  partial model HybridParts "The parts of the P2 hybrid, coupled without delay"
    parameter Boolean knows_limits = true "The control knows what the battery can give and take";
    Real torque_demand;
    Car car(mass=1550, wheel_radius=0.32, drag_area=0.66);
    AdasPowertrain.Parts.Engine15 engine;
    AdasPowertrain.Parts.Machine machine;
    AdasPowertrain.Parts.Battery battery(capacity=18000, resistance_share=0.12);
    AdasPowertrain.Parts.HybridGearbox gearbox;
    replaceable AdasPowertrain.Parts.HybridControl control constrainedby AdasPowertrain.Parts.HybridManagement;
    output Real speed = car.speed;
    output Real soc = battery.soc;
    output Real energy_in;
    output Real energy_out = gearbox.energy_out;
    output Real energy_loss;
    output Real energy_stored = battery.energy_stored + gearbox.energy_stored;
  protected
    Real fuel_energy(start=0, fixed=true);
    Real engine_loss(start=0, fixed=true);
  equation
    der(fuel_energy) = engine.fuel_power;
    der(engine_loss) = engine.loss_power;
    energy_in = battery.energy_in + fuel_energy;
    energy_loss = battery.energy_loss + machine.energy_loss + gearbox.energy_loss + engine_loss;
    control.torque_demand = torque_demand;
    control.ratio = gearbox.ratio;
    control.engine_speed = gearbox.engine_speed;
    control.machine_speed = gearbox.machine_speed;
    control.soc = battery.soc;
    control.discharge_power = if knows_limits then battery.discharge_power else 1e6;
    control.charge_power = if knows_limits then battery.charge_power else 1e6;
    control.machine_torque_limit = machine.torque_limit;
    engine.torque_demand = control.engine_torque_demand;
    engine.shaft_speed = gearbox.engine_speed;
    engine.on = true;
    machine.torque_demand = control.machine_torque_demand;
    machine.shaft_speed = gearbox.machine_speed;
    machine.voltage = battery.voltage;
    battery.electric_power = machine.electric_power;
    battery.charging_power = 0;
    gearbox.engine_torque = engine.torque;
    gearbox.machine_torque = machine.torque;
    gearbox.clutch = control.clutch;
    gearbox.wheel_speed_front = car.wheel_speed;
    gearbox.wheel_speed_rear = car.wheel_speed;
    car.drive_torque = gearbox.torque_front + gearbox.torque_rear;
  end HybridParts;

  model RangeExtenderInCar
    extends RangeExtenderParts(battery(initial_soc=0.4805), control(start_soc=0.475, stop_soc=0.4755, averaging=5));
    Driver driver;
  equation
    torque_demand = driver.torque_demand;
    car.brake_torque = 0;
  end RangeExtenderInCar;

  model HybridInCar
    extends HybridParts(battery(capacity=111600, resistance_share=0.4));
    Driver driver;
  equation
    torque_demand = 0.5 * driver.torque_demand;
    car.brake_torque = 0;
  end HybridInCar;

  partial model Chase "Follows a speed given from outside with its acceleration; brakes take what recuperation leaves"
    input Real target(start=0);
    input Real target_acceleration(start=0);
    parameter Real gain = 2000;
    parameter Real mass;
    parameter Real wheel_radius;
    parameter Real drag_area;
    Real actual;
    Real delivered "Torque of the powertrain on the wheels";
    Real wanted;
    Real brake;
  equation
    wanted = wheel_radius * (mass * target_acceleration + 0.009 * mass * 9.81 * tanh(actual / 0.1) + 0.6 * drag_area * actual * abs(actual))
      + gain * (target - actual);
    brake = noEvent(max(0, delivered - wanted)) * tanh(actual / 0.1);
  end Chase;

  model RangeExtenderOnCycle
    extends RangeExtenderParts;
    extends Chase(mass=1500, wheel_radius=0.34, drag_area=0.70);
  equation
    torque_demand = wanted;
    car.brake_torque = brake;
    actual = car.speed;
    delivered = car.drive_torque;
  end RangeExtenderOnCycle;

  model HybridOnCycle
    extends HybridParts;
    extends Chase(mass=1550, wheel_radius=0.32, drag_area=0.66);
  equation
    torque_demand = wanted;
    car.brake_torque = brake;
    actual = car.speed;
    delivered = car.drive_torque;
  end HybridOnCycle;

  model EquivalentOnCycle
    extends HybridParts(redeclare AdasPowertrain.Parts.HybridEquivalentControl control);
    extends Chase(mass=1550, wheel_radius=0.32, drag_area=0.66);
  equation
    torque_demand = wanted;
    car.brake_torque = brake;
    actual = car.speed;
    delivered = car.drive_torque;
  end EquivalentOnCycle;

  model ThermalHybridOnCycle "From -7 degrees Celsius, with one coolant circuit; where the energy goes, part by part"
    extends Chase(mass=1550, wheel_radius=0.32, drag_area=0.66);
    constant Real cold = 266.15;
    Car car(mass=1550, wheel_radius=0.32, drag_area=0.66);
    AdasPowertrain.Parts.ThermalEngine15 engine(initial_temperature=cold, ambient=cold);
    AdasPowertrain.Parts.ThermalMachine machine(initial_temperature=cold, ambient=cold);
    AdasPowertrain.Parts.ThermalBattery battery(series_cells=108, capacity=28800, resistance_share=0.12,
      initial_temperature=cold, ambient=cold);
    AdasPowertrain.Parts.HybridGearbox gearbox;
    AdasPowertrain.Parts.HybridEquivalentControl control;
    AdasPowertrain.Parts.CoolantCircuit coolant(circuit(engine_conductance=40, initial_temperature=cold, ambient=cold));
    output Real speed = car.speed;
    output Real given = fuel_energy + battery.energy_in "By fuel and cells";
    output Real wheel_work = gearbox.energy_out;
    output Real exhaust(start=0, fixed=true);
    output Real gears = gearbox.energy_loss "Heat of gears, clutches and shafts, to the air";
    output Real used = 350*time "By light and control units";
    output Real air(start=0, fixed=true) "From engine, machine and battery";
    output Real radiators(start=0, fixed=true) "Of the engine and of the coolant circuit";
    output Real engine_kelvin = engine.temperature;
    output Real machine_kelvin = machine.temperature;
    output Real battery_kelvin = battery.temperature;
    output Real coolant_kelvin = coolant.temperature;
    output Real motion = battery.energy_stored + gearbox.energy_stored "Rotating parts, twisted shafts and the battery's capacitors";
  protected
    Real fuel_energy(start=0, fixed=true);
  equation
    der(fuel_energy) = engine.fuel_power;
    actual = car.speed;
    delivered = car.drive_torque;
    car.drive_torque = gearbox.torque_front + gearbox.torque_rear;
    car.brake_torque = brake;
    control.torque_demand = wanted;
    control.ratio = gearbox.ratio;
    control.engine_speed = gearbox.engine_speed;
    control.machine_speed = gearbox.machine_speed;
    control.soc = battery.soc;
    control.discharge_power = battery.discharge_power;
    control.charge_power = battery.charge_power;
    control.machine_torque_limit = machine.torque_limit;
    engine.torque_demand = control.engine_torque_demand;
    engine.shaft_speed = gearbox.engine_speed;
    engine.on = true;
    machine.torque_demand = control.machine_torque_demand;
    machine.shaft_speed = gearbox.machine_speed;
    machine.voltage = battery.voltage;
    battery.electric_power = machine.electric_power;
    battery.charging_power = 0;
    gearbox.engine_torque = engine.torque;
    gearbox.machine_torque = machine.torque;
    gearbox.clutch = control.clutch;
    gearbox.wheel_speed_front = car.wheel_speed;
    gearbox.wheel_speed_rear = car.wheel_speed;
    coolant.engine_temperature = engine.temperature;
    coolant.machine_temperature = machine.temperature;
    coolant.battery_temperature = battery.temperature;
    engine.heat_flow = coolant.engine_heat;
    machine.heat_flow = coolant.machine_heat;
    battery.heat_flow = coolant.battery_heat;
    der(exhaust) = 0.6*engine.loss_power;
    der(air) = 15*(engine.temperature - cold) + 5*(machine.temperature - cold) + 4*(battery.temperature - cold);
    der(radiators) = 1500*noEvent(max(0, min(1, (engine.temperature - 363.15)/5)))*(engine.temperature - cold)
      + 250*noEvent(max(0, min(1, (coolant.temperature - 298.15)/5)))*(coolant.temperature - cold);
  end ThermalHybridOnCycle;

  model SmallBatteryOnCycle "96 cells of 1.5 A.h"
    extends EquivalentOnCycle(battery(capacity=5400));
    output Real cell_voltage = battery.voltage/96;
    output Real electric = machine.electric_power;
  end SmallBatteryOnCycle;

  model UnknownSmallBatteryOnCycle
    extends SmallBatteryOnCycle(knows_limits=false);
  end UnknownSmallBatteryOnCycle;

  model SplitBench "The engine's torque of least equivalent consumption"
    input Real shaft_torque(start=0);
    input Real speed(start=150);
    input Real equivalence(start=2.8);
    output Real torque = AdasPowertrain.Parts.equivalentSplit(shaft_torque, speed, 0.4, 25, 12, 150, 0.3, equivalence, 5.4, 0.047, 2.5e-6, 10, 200);
  end SplitBench;
end Electric;
