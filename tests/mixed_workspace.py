"""A workspace whose parts come from four tools, laid out as a user would come to it."""

from __future__ import annotations

import shutil
from pathlib import Path

from acc_texts import acc_files

_EXAMPLE = Path(__file__).parents[1] / "components"
_FOLDERS = (
    "AdasPowertrain",
    "brakes/friction_brake",
    "brakes/hydraulic_booster",
    "controllers/acc",
    "controllers/pd_acc",
    "powertrains/bev_single_speed",
    "powertrains/combustion_ideal",
    "powertrains/torque_source",
    "traffic/profile",
    "worlds/straight_road",
)

CODE = "AccControl_ert_rtw"
STRANGER = "ray_sensor"
"""Of the example, what is needed; generated code and a finished FMU lie beside it until they are imported."""

_DESIGN = """\
design: mixed
title: Cruise control, each part from another tool
root:
  compound:
    sensor: {alternatives: [ray_sensor, clean_sensor]}
    controller: {alternatives: [coded_acc, pd_acc]}
    brake: hydraulic_booster
    powertrain: {alternatives: [bev_single_speed, combustion_ideal]}
  connections:
    - sensor.target -> controller.target
    - controller.demand.drive_torque -> powertrain.torque_demand
    - controller.demand.brake_torque -> brake.torque_demand
"""
_BENCH = """\
testbench: following
title: Reach 70 km/h behind a car at 50 km/h
design: mixed
test_components:
  world:
    component: straight_road
    parameters: {initial_speed: 60 km/h, lead_speed: 50 km/h, initial_gap: 100 m}
connections:
  - world.scene.range -> sensor.scene.range
  - world.scene.closing_speed -> sensor.scene.closing_speed
  - world.scene.hit -> sensor.scene.hit
  - world.speed -> controller.speed
  - world.wheel_speed -> powertrain.wheel_speed
  - world.wheel_speed -> brake.wheel_speed
  - powertrain.wheels -> world.wheels
  - brake.torque -> world.brake
  - controller.mode -> world.status.mode
parameters:
  controller.set_speed: 70 km/h
  controller.set_gap: 40 m
simulation:
  stop: 21 s
  step: 10 ms
  record: [sensor.target, world.speed, controller.demand, controller.mode, controller.reference, world.gap]
metrics:
  gap_undershoot: {title: Gap undershoot, expression: "undershoot(world.gap, target = controller.set_gap)", unit: "%"}
  final_speed: {title: Speed at the end, expression: final(world.speed), unit: km/h}
requirements:
  R1: {title: gap kept, metric: gap_undershoot, at_most: 1 %}
figures:
  gap: {title: Distance, current: world.gap, target: controller.reference.gap, unit: m}
"""
_STUDY = """\
study: gains
title: Gains of the coded controller
testbench: following
configurations:
  where: controller is coded_acc and sensor is ray_sensor and powertrain is bev_single_speed
design_variables:
  controller.kp_speed: {range: [0.4, 2.4], levels: 3, title: speed P gain}
  controller.kp_gap: {range: [0.05, 0.3], levels: 3}
sampler: full_factorial
keep_waveforms: all
"""
# What a user writes who reads the FMU's list of variables.
_READER = """\
component: ray_sensor
implements: ray_reader
source: {kind: fmu, file: ray_sensor.fmu}
map:
  scene.range: Float64_continuous_input
  scene.closing_speed: Float64_discrete_input
  scene.hit: Boolean_input
  target.gap: Float64_continuous_output
  target.closing_speed: Float64_discrete_output
  target.detected: Boolean_output
"""
_CLEAN = {
    "interfaces.yaml": """\
interfaces:
  ray_reader:
    inputs: {scene: {range: m, closing_speed: m/s, hit: bool}}
    outputs: {target: {gap: m, closing_speed: m/s, detected: bool}}
""",
    "component.yaml": """\
component: clean_sensor
implements: ray_reader
source: {kind: c, files: [clean_sensor.c], header: clean_sensor.h, step: 10 ms}
""",
    "clean_sensor.h": """\
#pragma once
#include <stdbool.h>
typedef struct {
    struct { struct { double range, closing_speed; bool hit; } scene; } in;
    struct { struct { double gap, closing_speed; bool detected; } target; } out;
} clean_sensor;
void clean_sensor_init(clean_sensor *self);
void clean_sensor_step(clean_sensor *self);
""",
    "clean_sensor.c": """\
#include "clean_sensor.h"
void clean_sensor_init(clean_sensor *self) { clean_sensor_step(self); }
void clean_sensor_step(clean_sensor *self) {
    self->out.target.gap = self->in.scene.range;
    self->out.target.closing_speed = self->in.scene.closing_speed;
    self->out.target.detected = self->in.scene.hit;
}
""",
}


def lay_out(folder: Path) -> Path:
    """The workspace, without what is to be imported: the code lies in CODE, the design has its place already."""
    for name in _FOLDERS:
        shutil.copytree(_EXAMPLE / name, folder / "components" / name)
    shutil.copy(_EXAMPLE / "interfaces.yaml", folder / "components")
    texts = {
        "designs/mixed.yaml": _DESIGN,
        "testbenches/following.yaml": _BENCH,
        "testbenches/gains.pet.yaml": _STUDY,
        **{f"components/clean_sensor/{name}": text for name, text in _CLEAN.items()},
        **{f"{CODE}/{name}": text for name, text in acc_files().items()},
    }
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def map_the_stranger(folder: Path) -> None:
    """Write what its variables mean, in place of what its import has written."""
    imported = folder / "components" / STRANGER
    (imported / "interfaces.yaml").unlink()
    (imported / "component.yaml").write_text(_READER, encoding="utf-8")


def bench_with(folder: Path, name: str, simulation: str) -> None:
    """The same bench with another line for its step."""
    text = (folder / "testbenches" / "following.yaml").read_text(encoding="utf-8")
    text = text.replace("testbench: following", f"testbench: {name}").replace("step: 10 ms", simulation)
    (folder / "testbenches" / f"{name}.yaml").write_text(text, encoding="utf-8")
