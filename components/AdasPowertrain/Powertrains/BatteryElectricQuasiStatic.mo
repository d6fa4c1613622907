within AdasPowertrain.Powertrains;
model BatteryElectricQuasiStatic
  "Battery-electric drive of the rear axle: loss map, rigid shafts, battery with one resistance; torque follows at
   once. The same car and the same interface as BatteryElectric. What is left out: lags, the rotor's inertia,
   compliance, the battery's capacitors and the effect of its voltage on the machine."
  extends Interfaces.Powertrain;
  parameter Real ratio(min=2, max=20) = 11.53 "Speed of the machine over that of the wheels";
  parameter Real max_torque(unit="N.m", min=50, max=600) = 310 "Of the machine";
  parameter Real max_power(unit="W", min=20000, max=400000) = 150000 "Of the machine, at its shaft";
  parameter Real capacity(unit="C", min=36000, max=2e6) = 561600 "Of the battery; 3600 C = 1 Ah";
  parameter Integer series_cells(min=20, max=220) = 108 "Cells in series";
  parameter Real initial_soc(min=0, max=1) = 0.8 "State of charge at the start";
  parameter Real max_recuperation(unit="N.m", min=0, max=600) = 150 "Of the machine, recuperating";
  parameter Real auxiliary_power(unit="W", min=0, max=10000) = 350 "Taken from the link for light, cooling and control units";
  Interfaces.RealOutput soc "State of charge";
  Machines.TorqueRequest request(ratio=ratio, max_torque=max_torque, max_recuperation=max_recuperation);
  Machines.EfficiencyMap machine(max_torque=max_torque, max_power=max_power);
  Axles.MeshLoss mesh;
  Batteries.InternalResistance battery(series_cells=series_cells, capacity=capacity, initial_soc=initial_soc);
  Batteries.PowerLimits limits;
equation
  machine.shaft_speed = ratio * wheel_speed_rear;
  request.torque_demand = torque_demand;
  request.machine_speed = machine.shaft_speed;
  request.discharge_power = limits.discharge_power;
  request.charge_power = limits.charge_power;
  machine.torque_demand = request.machine_torque_demand;
  mesh.torque = machine.torque;
  mesh.speed = machine.shaft_speed;
  battery.electric_power = machine.electric_power + auxiliary_power;
  limits.soc = battery.soc;
  torque_front = 0;
  torque_rear = ratio * (machine.torque - mesh.loss_torque);
  soc = battery.soc;
  fuel_power = 0;
  battery_power = battery.battery_power;
  co2 = 0;
  loss_power = battery.loss + machine.loss + mesh.loss + auxiliary_power;
  energy_stored = 0;
end BatteryElectricQuasiStatic;
