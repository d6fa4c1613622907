"""FMUs whose results depend on more than their inputs are found by a second simulation, and named.

What differs between two instances of one process is refused when the FMU is tried first; here is what does not.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from dse.exploration.executors.local import Local
from dse.exploration.loop import explore
from dse.storage.folder import StudyFolder
from dse.testbench import make_runner
from dse.testbench.study import prepare_study
from zoo.animals import Animal, build_animal
from zoo.workspace import lay_out

pytestmark = [pytest.mark.thorough, pytest.mark.skipif(sys.platform != "linux", reason="calls of Linux")]

NOT_DETERMINISTIC = {
    "reads_its_process_id": Animal({"step": "a->real[Y] += 1e-9 * getpid();"}, before="#include <unistd.h>"),
    "reads_an_address": Animal({"step": "static int at; a->real[Y] += 1e-20 * (double)(size_t)&at;"}),
}


@pytest.mark.parametrize("name", NOT_DETERMINISTIC)
def test_it_is_named_with_the_signal_that_differs_first(tmp_path: Path, name: str) -> None:
    archive = build_animal(NOT_DETERMINISTIC[name], tmp_path / "built", name)
    workspace = lay_out(tmp_path / "work", [], {name: archive})
    pet = tmp_path / "work/testbenches/zoo.pet.yaml"
    pet.write_text(pet.read_text(encoding="utf-8").replace("[1, 2], levels: 2", "[1, 2], levels: 32"), encoding="utf-8")
    planned = prepare_study(workspace.study("zoo"), cache=tmp_path / "cache")
    with StudyFolder.create(tmp_path / "out", planned.definition) as store:
        summary = explore(
            workspace.study("zoo"), planned.benches, store, executor=Local(workers=2), make_runner=make_runner
        )
        said = [run.problem for run in store.table().runs() if run.problem]
    again = "not reproducible: simulated again it gave another result; the first to differ: 'head.y' at 0.6 s"
    # Two are repeated; in the other one it does not do it.
    assert said == [again]
    assert (summary.simulated, summary.irreproducible) == (64, 1)
