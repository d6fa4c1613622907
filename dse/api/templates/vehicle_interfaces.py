"""The start of a powertrain made of subsystems that follow the Modelica library VehicleInterfaces.

The wrapper maps their flanges and their control bus to the ports of the interface ``powertrain``.
"""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from dse.api.templates.write import headed
from dse.errors import fail

if TYPE_CHECKING:
    from dse.loading import Workspace

VEHICLE_INTERFACES = "vehicle_interfaces"
_INTERFACE = "powertrain"
_PORTS = {"torque_demand", "wheel_speed.front", "wheel_speed.rear", "wheels.front", "wheels.rear"} | {
    "fuel_power", "battery_power", "co2",
}  # fmt: skip
_INTERFACES = """\
interfaces:
  powertrain:
    title: From torque demand to the torques of both axles
    inputs:
      torque_demand: N.m                         # total of both axles, drives if > 0
      wheel_speed: {front: rad/s, rear: rad/s}
    outputs:
      wheels: {front: N.m, rear: N.m}
      fuel_power: W
      battery_power: W
      co2: kg/s
"""
_YAML = """\
component: @NAME@
title: @NAME@
implements: powertrain
source:
  kind: modelica
  model: @NAME@
  files: [@NAME@.mo]
  modelica_path: [$MODELICA_PATH]                # folders that contain VehicleInterfaces and Modelica
map:
  wheel_speed.front: wheel_speed_front
  wheel_speed.rear: wheel_speed_rear
  wheels.front: torque_front
  wheels.rear: torque_rear
parameters:
  full_torque: {start: 600 N.m, min: 1 N.m, max: 20 kN.m, title: demand at the wheels that is the whole pedal}
properties: {cost: 0 EUR, mass: 0 kg}            # values for the constraints of a design space
"""
_MODEL = """\
model @NAME@ "Engine, transmission and driveline of VehicleInterfaces as a powertrain"
  parameter Real full_torque(unit = "N.m") = 600 "Demand at the wheels that is the whole pedal";
  input Real torque_demand(unit = "N.m", start = 0) "At the wheels, both axles together; drives if > 0";
  input Real wheel_speed_front(unit = "rad/s", start = 0);
  input Real wheel_speed_rear(unit = "rad/s", start = 0);
  output Real torque_front(unit = "N.m") "On the wheels of the front axle";
  output Real torque_rear(unit = "N.m") "On the wheels of the rear axle";
  output Real fuel_power(unit = "W");
  output Real battery_power(unit = "W");
  output Real co2(unit = "kg/s");

  // Your subsystems: any models that extend VehicleInterfaces' interfaces. The mechanics stay in one dimension.
  inner Modelica.Mechanics.MultiBody.World world(enableAnimation = false, driveTrainMechanics3D = false);
  VehicleInterfaces.Engines.MinimalEngine engine;
  VehicleInterfaces.Transmissions.SingleGearAutomaticTransmission transmission;
  VehicleInterfaces.Drivelines.MinimalDriveline driveline;

  model Wheel "Its speed is given, the torque on it is found, which twists the half shaft"
    Modelica.Mechanics.Rotational.Interfaces.Flange_a flange;
    parameter Real stiffness(unit = "N.m/rad") = 15e3;
    parameter Real damping(unit = "N.m.s/rad") = 200;
    input Real speed(unit = "rad/s");
    Real torque(unit = "N.m") = flange.tau "Drives the wheel if > 0";
    Real twist(unit = "rad", start = 0, fixed = true);
  equation
    der(twist) = der(flange.phi) - speed;
    torque = stiffness*twist + damping*der(twist);
  end Wheel;
protected
  Wheel front_left(speed = wheel_speed_front);
  Wheel front_right(speed = wheel_speed_front);
  Wheel rear_left(speed = wheel_speed_rear);
  Wheel rear_right(speed = wheel_speed_rear);
  VehicleInterfaces.Interfaces.ControlBus controlBus;
  Modelica.Blocks.Interfaces.RealOutput pedal "0 to 1";
equation
  connect(engine.transmissionFlange, transmission.engineFlange);
  connect(transmission.drivelineFlange, driveline.transmissionFlange);
  connect(driveline.wheelHub_1.flange, front_left.flange);
  connect(driveline.wheelHub_2.flange, front_right.flange);
  connect(driveline.wheelHub_3.flange, rear_left.flange);
  connect(driveline.wheelHub_4.flange, rear_right.flange);

  // What a driver or a controller puts on the control bus. Add gear, clutch and brake if your models read them.
  connect(engine.controlBus, controlBus);
  connect(transmission.controlBus, controlBus);
  connect(driveline.controlBus, controlBus);
  pedal = max(0, min(1, torque_demand/full_torque));
  connect(pedal, controlBus.driverBus.acceleratorPedalPosition);

  torque_front = front_left.torque + front_right.torque;
  torque_rear = rear_left.torque + rear_right.torque;
  // The library prescribes no fuel and no battery: take them from your engine, as fuel_power = engine.fuelPower.
  fuel_power = 0;
  battery_power = 0;
  co2 = 0;
end @NAME@;
"""


def new_vehicle_interfaces(workspace: Workspace, name: str, implements: str | None) -> dict[PurePosixPath, str]:
    """The files of the component *name*, by their paths in *workspace*, with the interface if there is none.

    Raises DseError if it is to implement another interface, or the workspace's powertrain has other ports.
    """
    if implements not in (None, _INTERFACE):
        hint = f"leave out --implements: the template implements '{_INTERFACE}'"
        raise fail(f"the template '{VEHICLE_INTERFACES}' cannot implement '{implements}'", hint=hint)
    folder = PurePosixPath("components", name)
    files = {}
    known = workspace.interfaces.get(_INTERFACE)
    if known is None:
        files[folder / "interfaces.yaml"] = headed(_INTERFACES, 2, "interfaces")
    elif {port.name for port in known.ports} != _PORTS:
        hint = f"write the component by hand; the template has the ports {', '.join(sorted(_PORTS))}"
        raise fail(
            f"the interface '{_INTERFACE}' of this workspace has other ports than the template", known.where, hint
        )
    files[folder / "component.yaml"] = headed(_YAML.replace("@NAME@", name), 2, "component")
    files[folder / f"{name}.mo"] = _MODEL.replace("@NAME@", name)
    return files
