"""A small valid workspace that tests break in one place each."""

from __future__ import annotations

from pathlib import Path

import pytest

FILES = {
    "components/interfaces.yaml": """\
interfaces:
  sensor:
    inputs: {scene: {range: m, visible: bool}}
    outputs: {target: {gap: m, detected: bool}}
  controller:
    inputs:
      target: {gap: m, detected: bool}
      set_gap: m
    outputs:
      torque: N.m
      mode: enum[speed, distance]
""",
    "components/radar/component.yaml": """\
component: radar
title: A radar
implements: sensor
source: {kind: c, files: [radar.c], step: 50 ms}
parameters:
  range: {start: 150 m, min: 10 m, max: 300 m}
  setting: {start: near, enum: [near, far]}
properties: {cost: 45 EUR, mass: 300 g}
""",
    "components/radar/radar.c": """\
#include "radar.h"
void radar_init(radar *self) { (void)self; }
void radar_step(radar *self) {
    (void)self;
}
""",
    "components/radar/radar.h": """\
#include <stdbool.h>
#include <stdint.h>
typedef struct {
    struct { struct { double range; bool visible; } scene; } in;
    struct { struct { double gap; bool detected; } target; } out;
    struct { double range; int32_t setting; } par;
} radar;
void radar_init(radar *self);
void radar_step(radar *self);
""",
    "components/pd/component.yaml": """\
component: pd
implements: controller
source: {kind: c, files: [pd.c], step: 10 ms}
parameters:
  kp: {start: 0.8, min: 0, max: 5, unit: 1/s}
properties: {cost: 20 EUR}
""",
    "components/pd/pd.c": """\
#include "pd.h"
void pd_init(pd *self) { (void)self; }
void pd_step(pd *self) {
    (void)self;
}
""",
    "components/pd/pd.h": """\
#include <stdbool.h>
#include <stdint.h>
typedef struct {
    struct { struct { double gap; bool detected; } target; double set_gap, rim; } in;
    struct { double torque; int32_t mode; } out;
    struct { double kp; } par;
} pd;
void pd_init(pd *self);
void pd_step(pd *self);
""",
    "components/road/component.yaml": """\
component: road
implements: world
source: {kind: c, files: [road.c]}
""",
    "components/road/road.c": """\
#include "road.h"
void road_init(road *self) { (void)self; }
void road_step(road *self, double h) {
    (void)self;
    (void)h;
}
""",
    "components/road/road.h": """\
#include <stdbool.h>
#include <stdint.h>
typedef struct {
    struct { double torque; } in;
    struct { double gap, speed; struct { double range; bool visible; } scene; } out;
} road;
void road_init(road *self);
void road_step(road *self, double h);
""",
    "components/road/interfaces.yaml": """\
interfaces:
  world:
    inputs: {torque: N.m}
    outputs: {gap: m, speed: m/s, scene: {range: m, visible: bool}}
""",
    "designs/car.yaml": """\
design: car
root:
  compound:
    sensor: {alternatives: [radar]}
    controller: pd
  connections:
    - sensor.target -> controller.target
constraints:
  budget: {require: sum(cost) <= 100 EUR, because: target price}
""",
    "testbenches/following.yaml": """\
testbench: following
design: car
test_components:
  world: {component: road}
connections:
  - world.scene -> sensor.scene
  - controller.torque -> world.torque
parameters: {controller.set_gap: 40 m}
simulation: {stop: 10 s, step: 10 ms, record: [world.gap], record_every: 100 ms}
metrics:
  gap_undershoot: undershoot(world.gap, target = controller.set_gap)
requirements:
  R1: {metric: gap_undershoot, at_most: 1 %}
figures:
  gap: {current: world.gap, target: controller.set_gap}
""",
    "testbenches/gains.pet.yaml": """\
study: gains
testbench: following
design_variables:
  controller.kp: {range: [0.1, 3.0], levels: 5}
sampler: full_factorial
""",
}


class Files:
    """A workspace in a folder, edited by replacing text."""

    def __init__(self, root: Path) -> None:
        self.root = root
        for name, text in FILES.items():
            self.write(name, text)

    def write(self, name: str, text: str) -> Path:
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    def edit(self, name: str, old: str, new: str) -> Path:
        text = (self.root / name).read_text(encoding="utf-8")
        assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in {name}"
        return self.write(name, text.replace(old, new))


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Files:
    """The workspace, with the current folder at its root so that messages show short paths."""
    monkeypatch.chdir(tmp_path)
    return Files(tmp_path)
