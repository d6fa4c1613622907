within AdasPowertrain.Powertrains;
model BatteryElectric
  "Battery-electric drive of the rear axle: inverter and machine with torque lag and rotor, battery circuit, compliant
   half shafts. Volkswagen ID.3 Pro of 2020: 150 kW, 310 N.m, one reduction, rear axle (press kit 'The new ID.3',
   2020); 108 cells in series, two in parallel, 78 Ah each, ratio 11.53 (Wassiliadis et al., eTransportation 12, 2022,
   100167). The machine's flux, inductance and resistances are those of the non-salient equivalent that reaches 310
   N.m, 150 kW and a best efficiency of about 96 %."
  parameter Real ratio(min=2, max=20) = 11.53 "Speed of the machine over that of the wheels";
  parameter Real max_torque(unit="N.m", min=50, max=600) = 310 "Of the machine";
  parameter Real max_power(unit="W", min=20000, max=400000) = 150000 "Of the machine, at its shaft";
  parameter Real rotor_inertia(unit="kg.m2", min=0.005, max=0.3) = 0.05 "Of the machine, with the first gear";
  parameter Real capacity(unit="C", min=36000, max=2e6) = 561600 "Of the battery; 3600 C = 1 Ah";
  parameter Integer series_cells(min=20, max=220) = 108 "Cells in series";
  parameter Real initial_soc(min=0, max=1) = 0.8 "State of charge at the start";
  parameter Real max_recuperation(unit="N.m", min=0, max=600) = 150 "Of the machine, recuperating";
  parameter Real auxiliary_power(unit="W", min=0, max=10000) = 350 "Taken from the link for light, cooling and control units";
  parameter Real stiffness(unit="N.m/rad", min=500, max=50000) = 3000 "Of both half shafts and tyres together";
  parameter Real damping(unit="N.m.s/rad", min=10, max=1000) = 100 "Of both half shafts and tyres together";
  extends Interfaces.Powertrain;
  Interfaces.RealOutput soc "State of charge";
  Machines.TorqueRequest request(ratio=ratio, max_torque=max_torque, max_recuperation=max_recuperation);
  Machines.Dynamic machine(rotor_inertia=rotor_inertia, control(max_torque=max_torque, max_power=max_power));
  Batteries.Thevenin battery(circuit(series_cells=series_cells, capacity=capacity, initial_soc=initial_soc));
  Batteries.Auxiliaries auxiliaries(power=auxiliary_power);
  Axles.SingleSpeed axle(ratio=ratio, stiffness=stiffness, damping=damping);
initial equation
  machine.speed = ratio * axle.wheel_speed;
equation
  request.torque_demand = torque_demand;
  request.machine_speed = machine.speed;
  request.discharge_power = battery.discharge_power;
  request.charge_power = battery.charge_power;
  machine.torque_demand = request.machine_torque_demand;
  connect(machine.flange, axle.flange);
  connect(battery.link, machine.link);
  connect(battery.link, auxiliaries.link);
  axle.wheel_speed_front = wheel_speed_front;
  axle.wheel_speed_rear = wheel_speed_rear;
  torque_front = axle.torque_front;
  torque_rear = axle.torque_rear;
  soc = battery.circuit.soc;
  fuel_power = 0;
  battery_power = battery.circuit.battery_power;
  co2 = 0;
  loss_power = battery.circuit.loss + machine.loss + axle.loss + auxiliary_power;
  energy_stored = machine.kinetic_energy + axle.elastic_energy + battery.circuit.stored_energy;
end BatteryElectric;
