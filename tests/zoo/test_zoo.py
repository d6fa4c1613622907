"""What a misbehaving FMU does to a study: its own run is a row that says what happened, and nothing else is changed."""

from __future__ import annotations

import multiprocessing
import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest
from reference_fmus.build import WINDOWS

from dse.domain.run import Outcome, Run, Waveforms
from dse.exploration.executors.local import Local
from dse.exploration.loop import Explored, explore
from dse.storage.folder import StudyFolder
from dse.testbench import make_runner
from dse.testbench.study import prepare_study
from zoo.animals import ANIMALS, build_animal
from zoo.workspace import lay_out

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="signals, and what C libraries call things")


SOME = [
    "tame",
    "crashes",
    "hangs",
    "crashes_when_loaded",
    "refuses_to_be",
    "returns_an_error",
    "returns_nan",
    "lies_about_reset",
    "changes_the_folder",
    "changes_rounding",
]
"""One of each kind, for every day."""


@dataclass(frozen=True)
class Visit:
    """A study of all animals: runs and waveforms by animal, in the order of the numbers, and the files it left."""

    summary: Explored
    runs: Mapping[str, list[Run]]
    waveforms: Mapping[str, list[Waveforms | None]]
    files: set[str]


def visit(folder: Path, chosen: Sequence[str], archives: Mapping[str, Path] | None = None) -> Visit:
    study = lay_out(folder / "work", [] if archives else chosen, archives).study("zoo")
    planned = prepare_study(study, cache=folder / "cache")
    animals = {name: bench.system.element("head").model.archive.stem for name, bench in planned.benches.items()}
    desk, here = folder / "desk", Path.cwd()
    desk.mkdir()
    # A relative folder, as the command line has it: a worker that has gone elsewhere would not find it.
    os.chdir(desk)
    try:
        with StudyFolder.create(Path("out"), planned.definition) as store:
            summary = explore(study, planned.benches, store, executor=Local(workers=2), make_runner=make_runner)
            runs: dict[str, list[Run]] = {name: [] for name in chosen}
            waveforms: dict[str, list[Waveforms | None]] = {name: [] for name in chosen}
            for run in store.table().runs():
                runs[animals[run.request.configuration]].append(run)
                waveforms[animals[run.request.configuration]].append(store.waveforms(run.request.number))
    finally:
        os.chdir(here)
    return Visit(summary, runs, waveforms, {file.name for file in desk.iterdir()})


def bites(name: str, run: Run) -> bool:
    """Whether the animal was to do in *run* what makes it a failure."""
    animal = ANIMALS[name]
    return bool(animal.says) and (animal.every or run.request.point["head.bites"] == 1.0)


def untold(name: str, run: Run) -> list[str]:
    """What the row of a run in which the animal bit should say and does not."""
    missing = [piece for piece in ANIMALS[name].says if piece not in run.problem]
    is_failure = run.outcome is Outcome.FAILED and run.judgements[0].verdict == "failed to run"
    return [run.problem, *missing] if missing or not is_failure else []


def changes(run: Run, waveforms: Waveforms | None, tame: Run, expected: Waveforms | None) -> list[str]:
    """What is not as it is with a tame FMU."""
    assert expected is not None
    same = waveforms is not None and {k: x.tobytes() for k, x in waveforms.values.items()} == {
        k: x.tobytes() for k, x in expected.values.items()
    }
    results = (run.metrics, run.judgements) == (tame.metrics, tame.judgements)
    return [run.problem] * bool(run.problem) + ["results"] * (not results) + ["waveforms"] * (not same)


@pytest.mark.parametrize("chosen", [SOME, pytest.param([*ANIMALS], marks=pytest.mark.thorough)], ids=["some", "all"])
@pytest.mark.thorough
def test_each_animal_gets_a_row_that_says_what_it_did_and_changes_no_other_run(
    chosen: Sequence[str], tmp_path: Path, few_files: None
) -> None:
    judge(visit(tmp_path, chosen), chosen)


OF_WINDOWS = [
    "tame",
    "crashes",
    "exits",
    "hangs",
    "leaks",
    "hangs_in_instantiate",
    "refuses_to_be",
    "needs_a_tool",
    "wrong_guid",
    "lacks_a_function",
    "returns_an_error",
    "returns_fatal",
    "discards",
    "returns_garbage",
    "fails_in_initialization",
    "returns_nan",
]
"""Those that do on Windows what they do here."""


@pytest.mark.thorough
def test_animals_of_windows_get_the_same_rows_through_wine(tmp_path: Path, wine_cache: Path) -> None:
    (tmp_path / "cache").symlink_to(wine_cache)
    archives = {name: build_animal(ANIMALS[name], tmp_path / "built", name, WINDOWS) for name in OF_WINDOWS}
    judge(visit(tmp_path, OF_WINDOWS, archives), OF_WINDOWS)


def judge(study: Visit, chosen: Sequence[str]) -> None:
    tame, tame_waveforms = study.runs["tame"], study.waveforms["tame"]
    for run in tame:
        # y(t) = gain (t + u), u as it was a step of 0.1 s before; head and tail both count from 0.
        gain = run.request.point["tail.gain"]
        assert isinstance(gain, float)
        assert run.metrics == pytest.approx({"head": 1.0, "last": gain * 1.9})
    assert {name: len(runs) for name, runs in study.runs.items()} == dict.fromkeys(chosen, 4)
    told = {name: [untold(name, run) for run in runs if bites(name, run)] for name, runs in study.runs.items()}
    assert {name: found for name, found in told.items() if any(found)} == {}
    others = {
        name: [
            changes(run, waves, tame[i], tame_waveforms[i])
            for i, (run, waves) in enumerate(zip(runs, study.waveforms[name], strict=True))
            if not bites(name, run)
        ]
        for name, runs in study.runs.items()
    }
    assert {name: found for name, found in others.items() if any(found)} == {}
    # Runs of the same kind are told in the same words, but for how far a leak got.
    words = {name: {run.problem for run in runs if bites(name, run)} for name, runs in study.runs.items()}
    assert {name for name, problems in words.items() if len(problems) > 1} <= {"leaks"}
    assert study.summary.irreproducible == 0
    assert study.files == {"out"}
    assert multiprocessing.active_children() == []
