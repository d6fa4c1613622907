"""A workspace with a part that integrates and shows what it is fed with, for benches with ``inputs``."""

from __future__ import annotations

from pathlib import Path

INTERFACES = """\
interfaces:
  fed:
    inputs: {u: m/s, gear: int, on: bool, mode: "enum[eco, sport]"}
    outputs: {y: m, seen: m/s, gear_seen: int, on_seen: bool, mode_seen: "enum[eco, sport]"}
  profile: {outputs: {u: m/s}}
"""
HEADER = """\
#pragma once
#include <stdbool.h>
#include <stdint.h>
typedef struct {
    struct { double u; int32_t gear; bool on; int32_t mode; } in;
    struct { double y, seen; int32_t gear_seen; bool on_seen; int32_t mode_seen; } out;
} part;
void part_init(part *self);
void part_step(part *self, double h);
"""
CODE = """\
#include "part.h"
void part_init(part *self) { (void)self; }
void part_step(part *self, double h) {
    self->out.y += h * self->in.u;
    self->out.seen = self->in.u;
    self->out.gear_seen = self->in.gear;
    self->out.on_seen = self->in.on;
    self->out.mode_seen = self->in.mode;
}
"""
BENCH = """\
testbench: fed
design: fed
inputs:
  part.u: {INPUT}
parameters: {part.gear: 0, part.on: false, part.mode: eco}
simulation: {stop: 2 s, step: 100 ms, record: [inputs.part.u, part.y, part.seen]METHOD}
metrics: {distance: final(part.y), fed: integral(inputs.part.u)}
"""
LEAD = "time [s],v [km/h]\n0,0\n0.35,12.6\n1,9\n2,36\n"
"""km/h, so that 0, 3.5, 2.5 and 10 m/s; corners between and at the steps of the bench."""


def lay_out(folder: Path, entry: str = "file: lead.csv, column: v", *, method: str = "", **files: str | bytes) -> Path:
    """The workspace *folder*, whose bench feeds ``part.u`` by *entry*; *files* are put beside the bench."""
    written: dict[str, str | bytes] = {
        "components/interfaces.yaml": INTERFACES,
        "components/part/component.yaml": "component: part\nimplements: fed\nsource: {kind: c, files: [part.c]}\n",
        "components/part/part.h": HEADER,
        "components/part/part.c": CODE,
        "designs/fed.yaml": "design: fed\nroot: {compound: {part: part}}\n",
        "testbenches/fed.yaml": BENCH.replace("INPUT", entry).replace("METHOD", method),
        "testbenches/lead.csv": LEAD,
        **{f"testbenches/{name.replace('__', '.')}": content for name, content in files.items()},
    }
    for name, content in written.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return folder
