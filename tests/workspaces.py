"""Workspaces that tests write: files by path, among them a mass on a spring."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path


def written(folder: Path, files: Mapping[str, str | bytes]) -> Path:
    """*folder*, with *files* by path."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return folder


OSCILLATOR = {
    "components/interfaces.yaml": """\
interfaces:
  spring: {inputs: {x: m}, outputs: {force: N}}
  mass: {inputs: {force: N}, outputs: {x: m}}
""",
    "components/spring/component.yaml": """\
component: spring
implements: spring
source: {kind: c, files: [spring.c]}
""",
    "components/spring/spring.h": """\
typedef struct { struct { double x; } in; struct { double force; } out; } spring;
void spring_init(spring *self);
void spring_step(spring *self, double h);
""",
    "components/spring/spring.c": """\
#include "spring.h"
void spring_init(spring *self) { self->out.force = -self->in.x; }
void spring_step(spring *self, double h) { (void)h; self->out.force = -self->in.x; }
""",
    "components/mass/component.yaml": """\
component: mass
implements: mass
source: {kind: c, files: [mass.c]}
parameters: {start: {start: 1 m}, fails_below: {start: 0 s, unit: s}, far: {start: 9 m}}
""",
    "components/mass/mass.h": """\
typedef struct {
    struct { double force; } in; struct { double x; } out; struct { double start, fails_below, far; } par; double v;
} mass;
void mass_init(mass *self);
void mass_step(mass *self, double h);
""",
    # Exact for a force that is held: all of the error is the coupling's, of first order.
    "components/mass/mass.c": """\
#include "mass.h"
#include <math.h>
void mass_init(mass *self) { self->out.x = self->par.start; self->v = 0.0; }
void mass_step(mass *self, double h) {
    self->out.x += h * self->v + 0.5 * h * h * self->in.force;
    self->v += h * self->in.force;
    if (h < self->par.fails_below) self->out.x = sqrt(-1.0 - h);
}
""",
    "designs/one.yaml": """\
design: one
root:
  compound: {spring: spring, mass: mass}
  connections: [spring.force -> mass.force, mass.x -> spring.x]
""",
}
"""A mass on a spring, each a component in C: x is cos(t) times where it starts."""
