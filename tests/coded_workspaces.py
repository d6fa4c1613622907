"""A tiny workspace with components of the kind simulink, for which the tests write the generated code."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path

from workspaces import written

Code = Mapping[str, str | bytes]
"""What a folder of generated code holds, by file name."""

_INTERFACES = """\
interfaces:
  signal: {outputs: {speed: m/s, enable: bool}}
  lag: {inputs: {speed: m/s, enable: bool}, outputs: {filtered: m/s}}
"""
_COMPONENT = """\
component: %s
implements: lag
source: {kind: simulink, folder: %s_ert_rtw%s}
"""
_SIGNAL = {
    "signal/component.yaml": """\
component: signal
implements: signal
source: {kind: c, files: [signal.c], step: 100 ms}
parameters: {slope: {start: 0.25 m/s}}
""",
    "signal/signal.h": """\
#pragma once
#include <stdbool.h>
typedef struct { struct { double slope; } par; struct { double speed; bool enable; } out; int k; } signal;
void signal_init(signal *self);
void signal_step(signal *self);
""",
    "signal/signal.c": """\
#include "signal.h"
void signal_init(signal *self) { self->out.speed = 1; self->out.enable = true; self->k = 0; }
void signal_step(signal *self) {
    self->k++;
    self->out.speed = 1 + self->par.slope * self->k;
    self->out.enable = self->k % 7 != 3;
}
""",
}
_BENCH = """\
testbench: see
design: one
test_components: {signal: {component: signal}}
connections: [%s]
simulation: {stop: %s, step: 100 ms, record: [%s], timeout: %s}
metrics: {end: final(%s.filtered)}
"""
_STUDY = """\
study: all
testbench: see
design_variables: {signal.slope: {range: [0.25, 0.5], levels: 2}}
sampler: full_factorial
keep_waveforms: none
"""


def workspace(
    root: Path,
    models: Mapping[str, Code],
    *,
    more: str = "step: 0.1 s",
    stop: str = "2 s",
    timeout: str = "20 s",
    is_together: bool = False,
) -> Path:
    """One part that any of *models* can be, components by name, or a part for each; *more* stands in their sources."""
    shutil.rmtree(root / "components", ignore_errors=True)
    files: dict[str, str | bytes] = {"components/interfaces.yaml": _INTERFACES}
    files |= {f"components/{name}": text for name, text in _SIGNAL.items()}
    for name, code in models.items():
        files[f"components/{name}/component.yaml"] = _COMPONENT % (name, name, f", {more}" if more else "")
        files |= {f"components/{name}/{name}_ert_rtw/{file}": content for file, content in code.items()}
    parts = {"part": f"{{alternatives: [{', '.join(models)}]}}" if len(models) > 1 else next(iter(models))}
    if is_together:
        parts = {name: name for name in models}
    compound = ", ".join(f"{name}: {part}" for name, part in parts.items())
    files["designs/one.yaml"] = f"design: one\nroot: {{compound: {{{compound}}}}}\n"
    wires = ", ".join(f"signal.{port} -> {part}.{port}" for part in parts for port in ("speed", "enable"))
    record = ", ".join(f"{part}.filtered" for part in parts)
    files["testbenches/see.yaml"] = _BENCH % (wires, stop, record, timeout, next(iter(parts)))
    files["testbenches/all.pet.yaml"] = _STUDY
    return written(root, files)


SPEEDS = [1 + 0.25 * k for k in range(21)]
ENABLED = [k % 7 != 3 for k in range(21)]
"""What the signal gives at each step until 2 s."""
