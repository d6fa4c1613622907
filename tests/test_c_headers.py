"""Which C file includes which: in one direction between folders, in no circle, and all that it needs."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from fmu.modelica_models.models import OSCILLATOR

import dse
from dse.fmu.toolchain.compiler import find_compiler

DSE = Path(dse.__file__).parent

MAY_INCLUDE: Mapping[str, frozenset[str]] = {
    "csolve": frozenset(),
    "fmu/runtime": frozenset({"csolve"}),
    "fmu/bridge": frozenset(),
    "cosim/kernel": frozenset({"csolve"}),
    "simulink/headers": frozenset(),
    "world/core": frozenset(),
    "world/openscenario/core": frozenset({"world/core"}),
}
"""By folder, the other folders it may include; one that is not here may hold no C."""

GENERATED = {"model.h": ("slot.h", "arithmetic.h", "modelica.h")}
"""Written for each component, beside the runtime."""

WRITTEN = frozenset({"scenario.h", "scenario_sizes.h"})
"""Written for each scenario, beside its core."""

BESIDE = {"world/openscenario/core": "world/core"}
"""Folders whose files are built in one with those of another."""

INCOMPLETE = frozenset({
    "modelica.h",  # needs the sizes that model.h defines before it
    "fmi2_exchange.h", "fmi3_exchange.h", "fmi3_refused.h", "fused_part.h",  # ends of a unit: further functions
    "c_component.h", "c_component_osmp.h",  # need a model.h of a component in C
    "datagram.h", "udp.h", "udp_told.h", "web.h",  # need the sizes of a component's packets, or of a page's systems
    "host.c",  # is for Windows
})  # fmt: skip
"""What cannot stand alone; nor can the solvers, which ask things of whoever includes them,
and the core of scenarios, which needs sizes."""

_INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)


def _sources() -> list[Path]:
    return sorted(path for path in DSE.rglob("*.[ch]") if "node_modules" not in path.parts)


def _included(path: Path) -> Iterator[Path]:
    """What *path* includes of ours; what is written ``"folder/name.h"`` lies below dse."""
    for name in _INCLUDE.findall(path.read_text("utf-8")):
        if name in WRITTEN:
            continue
        places = [path.parent / name, DSE / name, DSE / BESIDE.get(_folder(path), "") / name]
        found = next((place.resolve() for place in places if place.is_file()), None)
        assert found or name in GENERATED, f"{path.relative_to(DSE)} includes {name}, which is nowhere"
        yield found or path.parent / name


def _graph() -> dict[Path, list[Path]]:
    runtime = DSE / "fmu" / "runtime"
    graph = {path: list(_included(path)) for path in _sources()}
    return graph | {runtime / name: [runtime / each for each in names] for name, names in GENERATED.items()}


def _folder(path: Path) -> str:
    return path.parent.relative_to(DSE).as_posix()


def test_includes_form_no_circle():
    try:
        TopologicalSorter(_graph()).prepare()
    except CycleError as circle:
        pytest.fail(" -> ".join(path.name for path in circle.args[1]))


def test_folders_include_each_other_in_one_direction():
    wrong = [
        f"{path.relative_to(DSE)} includes {included.relative_to(DSE)}"
        for path, names in _graph().items()
        for included in names
        if _folder(included) not in {_folder(path), *MAY_INCLUDE[_folder(path)]}
    ]
    assert not wrong


@pytest.mark.thorough
def test_a_header_includes_what_it_needs(tmp_path):
    (tmp_path / "model.h").write_text(OSCILLATOR.header(), encoding="utf-8")
    headers = [path for path in _sources() if _folder(path) not in {"csolve", *BESIDE} and path.name not in INCOMPLETE]
    for number, path in enumerate(headers):
        (tmp_path / f"{number}.c").write_text(f'#include "{path.as_posix()}"\n', encoding="utf-8")
    seen = [f"-I{folder}" for folder in (".", DSE, DSE / "fmu" / "runtime", DSE / "simulink" / "headers")]
    strict = ["-std=c11", "-fsyntax-only", "-Werror=implicit-function-declaration", '-DDSE_SOURCES=""']
    units = [f"{number}.c" for number in range(len(headers))]
    done = subprocess.run(
        [*find_compiler().command, *strict, *seen, *units], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert [line for line in done.stderr.splitlines() if "error:" in line] == []
    assert done.returncode == 0
