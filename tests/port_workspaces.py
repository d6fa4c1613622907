"""Workspaces with components in C that exchange arrays, structures, texts and binaries, written by the tests."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from workspaces import written

from dse.domain.run import Outcome, Run, RunRequest
from dse.loading.workspace import Workspace
from dse.space.space import open_space
from dse.testbench.prepare import prepare_bench
from dse.testbench.runner import Runner

OBJECTS = """\
#pragma once
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
typedef struct { double x, y; } point;
typedef struct { int32_t id; uint8_t kind; bool seen; point at; float v; double corners[2][2]; } object;
"""
TYPES = """\
types:
  kind: enum[car, truck, bike]
  vector: {x: m, y: m}
  object: {id: int, kind: kind, seen: bool, at: vector, v: m/s, corners: "m[2, 2]"}
"""


def write(folder: Path, files: Mapping[str, str]) -> Path:
    """*files* below *folder*, which is a workspace then."""
    return written(folder, files)


def c_part(name: str, members: str, step: str, *, parameters: str = "", head: str = OBJECTS) -> dict[str, str]:
    """A sampled component in C: the *members* of its struct, and what a *step* does, at time 0 too."""
    here = f"components/{name}"
    return {
        f"{here}/component.yaml": f"component: {name}\nimplements: {name}\n"
        f"source: {{kind: c, files: [{name}.c], step: 10 ms}}\n{parameters}",
        f"{here}/{name}.h": f"{head}typedef struct {{ {members} int k; }} {name};\n"
        f"void {name}_init({name} *self);\nvoid {name}_step({name} *self);\n",
        f"{here}/{name}.c": f'#include "{name}.h"\n#include <string.h>\n'
        f"static void show({name} *s) {{ {step} }}\n"
        f"void {name}_init({name} *self) {{ show(self); }}\n"
        f"void {name}_step({name} *self) {{ self->k++; show(self); }}\n",
    }


def bench(connections: str, record: str, *, parts: str, more: str = "", step: str = "10 ms") -> dict[str, str]:
    """A design of one part and a bench ``see`` with the others."""
    return {
        "designs/one.yaml": "design: one\nroot: {compound: {sink: sink}}\n",
        "testbenches/see.yaml": f"testbench: see\ndesign: one\ntest_components: {{{parts}}}\n"
        f"connections: [{connections}]\nsimulation: {{stop: 0.2 s, step: {step}, record: [{record}]}}\n{more}",
    }


def run(root: Path, *, version: int = 2, cache: Path | None = None) -> Run:
    """The bench ``see``, run once."""
    tested = Workspace(root).bench("see")
    (prepared,) = prepare_bench(
        tested, open_space(tested.design).configurations(), version=version, cache=cache
    ).values()
    with Runner(prepared) as runner:
        found = runner.run(RunRequest(0, prepared.configuration.id, {}), keep=True)
        again = runner.run(RunRequest(1, prepared.configuration.id, {}), keep=True)
    if found.outcome is Outcome.DONE:
        assert found.metrics == again.metrics
    return found


def columns(root: Path, *, version: int = 2, cache: Path | None = None) -> dict[str, NDArray[np.float64]]:
    """The recorded waveforms of the bench ``see``."""
    made = run(root, version=version, cache=cache)
    assert made.waveforms is not None, made.problem
    return dict(made.waveforms.values)
