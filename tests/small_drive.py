"""A workspace with one bench that can be driven: a point that goes where it is steered."""

from __future__ import annotations

from pathlib import Path

from workspaces import written

INTERFACES = """\
interfaces:
  driver:
    outputs: {accelerator: "1", steering: rad, cruise: bool, gear: 'enum[park, drive]'}
  car:
    inputs: {accelerator: "1", steering: rad, cruise: bool, gear: 'enum[park, drive]'}
    outputs: {motion: {x: m, y: m, heading: rad, speed: m/s}}
"""

_HANDS = """\
component: idle
title: Nobody
implements: driver
source: {kind: c, files: [idle.c]}
"""

_HANDS_C = """\
#include "idle.h"
void idle_init(idle *self) { self->out.cruise = true; self->out.gear = 1; }
void idle_step(idle *self, double h) { (void)self; (void)h; }
"""

_HANDS_H = """\
#include <stdbool.h>
#include <stdint.h>
typedef struct { struct { double accelerator, steering; bool cruise; int32_t gear; } out; } idle;
void idle_init(idle *self);
void idle_step(idle *self, double h);
"""

_CAR = """\
component: dot
title: A point
implements: car
source: {kind: c, files: [dot.c]}
parameters:
  gain: {start: 18 km/h, min: 0 km/h, max: 180 km/h, title: speed gained in a second}
  doomed: {start: 1000 s, min: 0 s, max: 2000 s, title: when it crashes}
"""

_CAR_C = """\
#include <stdlib.h>
#include "dot.h"
void dot_init(dot *self) { (void)self; }
void dot_step(dot *self, double h) {
    self->time += h;
    if (self->time > self->par.doomed) abort();
    self->out.motion.heading += self->in.steering * h;
    self->out.motion.speed += self->par.gain * self->in.accelerator * h;
    self->out.motion.x += self->out.motion.speed * h;
    self->out.motion.y += self->out.motion.heading * self->out.motion.speed * h;
}
"""

_CAR_H = """\
#include <stdbool.h>
#include <stdint.h>
typedef struct {
    struct { double accelerator, steering; bool cruise; int32_t gear; } in;
    struct { double gain, doomed; } par;
    struct { struct { double x, y, heading, speed; } motion; } out;
    double time;
} dot;
void dot_init(dot *self);
void dot_step(dot *self, double h);
"""

_DESIGN = """\
design: cars
root:
  compound:
    car: {alternatives: [dot]}
"""

_BENCH = """\
testbench: field
title: An open field
design: cars
test_components:
  driver: {component: idle}
connections:
  - driver.accelerator -> car.accelerator
  - driver.steering -> car.steering
  - driver.cruise -> car.cruise
  - driver.gear -> car.gear
parameters: {car.gain: 9 km/h}
simulation: {stop: STOP, step: 10 ms, record: [car.motion.x], record_every: 100 ms}
metrics:
  way: {expression: final(car.motion.x), unit: m}
requirements:
  R1: {title: goes nowhere, metric: way, at_most: 1000 m}
figures:
  speed: {title: Speed, current: car.motion.speed, unit: km/h}
"""

_FILES = {
    "components/interfaces.yaml": INTERFACES,
    "components/idle/component.yaml": _HANDS,
    "components/idle/idle.c": _HANDS_C,
    "components/idle/idle.h": _HANDS_H,
    "components/dot/component.yaml": _CAR,
    "components/dot/dot.c": _CAR_C,
    "components/dot/dot.h": _CAR_H,
    "designs/cars.yaml": _DESIGN,
}


def drive_workspace(root: Path, stop: str = "20 s") -> Path:
    """The folder *root* as that workspace, whose bench ``field`` lasts *stop*."""
    return written(root, {**_FILES, "testbenches/field.yaml": _BENCH.replace("STOP", stop)})
