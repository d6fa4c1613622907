"""What an FMU can reach in a sandbox: what it needs, and nothing else; outside of one, all of it."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest
from sandbox_tries import has_sandbox

from dse.domain.run import Outcome, Run
from dse.exploration.executors.local import Local
from dse.exploration.loop import explore
from dse.storage.folder import StudyFolder
from dse.testbench import make_runner
from dse.testbench.study import prepare_study
from zoo.intruder import FORBIDDEN, build_intruder, missed, reached
from zoo.workspace import lay_out

needs_sandbox = pytest.mark.skipif(not has_sandbox(), reason="this machine has no sandbox")
on_linux = pytest.mark.skipif(sys.platform != "linux", reason="tries what Linux has")


@dataclass(frozen=True)
class Intrusion:
    """A study of a tame and an intruding FMU: its runs, by who they are of; and what then lies in the home."""

    tame: list[Run]
    intruder: list[Run]
    home: Mapping[str, str]


def intrude(place: Path, *, sandbox: bool) -> Intrusion:
    archive = build_intruder(place)
    home = place / "home"
    (home / ".ssh").mkdir(parents=True)
    for name in ("kept", "emptied", ".ssh/id"):
        (home / name).write_text("precious", "utf-8")
    planned = prepare_study(lay_out(place / "work", ["tame"], {"intruder": archive}).study("zoo"))
    animals = {name: bench.system.element("head").model.archive.stem for name, bench in planned.benches.items()}
    here = Path.cwd()
    os.chdir(place)
    try:
        with StudyFolder.create(Path("out"), planned.definition) as store:
            local = Local(workers=1, sandbox=sandbox)
            explore(planned.study, planned.benches, store, executor=local, make_runner=make_runner)
            runs = list(store.table().runs())
            assert all(store.waveforms(run.request.number) is not None for run in runs)
    finally:
        os.chdir(here)
    left = {path.name: path.read_text("utf-8") for path in home.rglob("*") if path.is_file()}
    by_animal = {name: [run for run in runs if animals[run.request.configuration] == name] for name in animals.values()}
    return Intrusion(by_animal["tame"], by_animal["intruder"], left)


def last_of(runs: list[Run]) -> float:
    """What the intruder says in the end."""
    return max(run.metrics["head"] for run in runs)


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    folder = tmp_path / "place"
    folder.mkdir()
    monkeypatch.setenv("INTRUDER_PLACE", str(folder))
    return folder


@needs_sandbox
@pytest.mark.thorough
def test_in_a_sandbox_an_fmu_reaches_nothing_that_is_not_its_own(place: Path) -> None:
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(place / "socket"))
        listening.listen()
        intrusion = intrude(place, sandbox=True)
    assert {run.outcome for run in (*intrusion.tame, *intrusion.intruder)} == {Outcome.DONE}
    assert reached(last_of(intrusion.intruder)) == set()
    assert missed(last_of(intrusion.intruder)) == set()
    assert intrusion.home == dict.fromkeys(("kept", "emptied", "id"), "precious")
    expected = [1.9 * float(run.request.point["tail.gain"]) for run in intrusion.tame]
    assert [run.metrics["last"] for run in intrusion.tame] == pytest.approx(expected, rel=1e-12)


@on_linux
@pytest.mark.thorough
def test_outside_of_a_sandbox_an_fmu_reaches_all_of_it(place: Path) -> None:
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(place / "socket"))
        listening.listen()
        intrusion = intrude(place, sandbox=False)
    assert reached(last_of(intrusion.intruder)) == FORBIDDEN
    assert intrusion.home["kept"] == "pre"
