"""A workspace in which any of the animals is the head of a pair; the tail is always tame."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

from workspaces import written

from dse.loading.workspace import Workspace
from zoo.animals import ANIMALS, build_animal

_COMPONENT = """\
component: {component}
implements: {role}
source: {{kind: fmu, file: {animal}.fmu}}
parameters:
  bites: {{start: 0, tunable: false}}
  gain: {{start: 1, tunable: false}}
"""

_FILES = {
    "components/interfaces.yaml": """\
interfaces:
  source: {outputs: {y: 1}}
  filter: {inputs: {u: 1}, outputs: {y: 1}}
""",
    "testbenches/pair.yaml": """\
testbench: pair
design: pair
simulation: {stop: 1 s, step: 100 ms, record: [head.y, tail.y], timeout: 2 s, memory: 300 MB}
metrics: {last: final(tail.y), head: final(head.y)}
requirements: {R1: {metric: last, at_most: 1000}}
""",
    "testbenches/zoo.pet.yaml": """\
study: zoo
testbench: pair
design_variables:
  head.bites: {range: [0, 1], levels: 2}
  tail.gain: {range: [1, 2], levels: 2}
keep_waveforms: all
""",
}


def lay_out(folder: Path, animals: Sequence[str], archives: Mapping[str, Path] | None = None) -> Workspace:
    """The workspace with *animals*, built, and with components for other *archives*."""
    others = archives or {}
    design = f"""\
design: pair
root:
  compound:
    head: {{alternatives: [{", ".join([*animals, *others])}]}}
    tail: follower
  connections: [head.y -> tail.u]
"""
    written(folder, {**_FILES, "designs/pair.yaml": design})
    built = [(name, name, "source") for name in animals]
    for component, animal, role in [
        *built,
        *((name, name, "source") for name in others),
        ("follower", "tame", "filter"),
    ]:
        home = folder / "components" / component
        home.mkdir()
        text = _COMPONENT.format(component=component, animal=animal, role=role)
        (home / "component.yaml").write_text(text, encoding="utf-8")
        if animal in others:
            shutil.copy(others[animal], home)
        else:
            build_animal(ANIMALS[animal], home, animal)
    return Workspace(folder)
