"""Strings that are traps, read over a wire."""

from __future__ import annotations

import resource
import sys
from pathlib import Path

import pytest
from reference_fmus.systems import system_of

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.system import SystemStructure
from dse.fmu.unpack import open_fmu
from zoo.animals import build_animal
from zoo.text_animals import TEXT_ANIMALS

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="memfd_create")


def pair(name: str, folder: Path) -> SystemStructure:
    models = {
        "head": open_fmu(build_animal(TEXT_ANIMALS[name], folder, name), cache=folder / "cache"),
        "tail": open_fmu(build_animal(TEXT_ANIMALS["not_utf8"], folder, "reader"), cache=folder / "cache"),
    }
    wires = ["head.y -> tail.u", "head.text -> tail.text_in"]
    return system_of(models, wires, ["tail.y"], start={"head.bites": 1.0})


@pytest.mark.parametrize("name", TEXT_ANIMALS)
def test_a_string_that_is_a_trap_is_told_by_name(name: str, tmp_path: Path) -> None:
    animal = TEXT_ANIMALS[name]
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with Simulator(pair(name, tmp_path), ["tail.y"]) as simulator:
        if animal.says:
            with pytest.raises(RunFailed) as caught:
                simulator.run(stop=1.0, step=0.1)
            assert caught.value.element == "head"
            assert [piece for piece in animal.says if piece not in str(caught.value)] == [], str(caught.value)
        else:
            simulator.run(stop=1.0, step=0.1)
        # And it is as good as new if it is not made to bite.
        assert simulator.run(stop=1.0, step=0.1, start={"head.bites": 0.0})[-1, 0] == pytest.approx(1.9)
    # ru_maxrss counts in KiB: nobody has made a copy of a gigabyte.
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000
