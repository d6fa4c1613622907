"""Studies whose runs are not known beforehand: samplers that look at results, and studies that are extended."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from dse_example.bisection import Bisection
from fake_runners import benches, definition_of, make_fake, study_of

from dse.domain.definition import StudyDefinition
from dse.domain.sampler import Brief, Candidate
from dse.domain.study import Keep, Study
from dse.errors import DseError
from dse.exploration.executors.local import Local
from dse.exploration.loop import Explored, explore
from dse.exploration.samplers.boundary import Boundary
from dse.exploration.samplers.full_factorial import FullFactorial
from dse.exploration.samplers.latin_hypercube import LatinHypercube
from dse.exploration.samplers.sobol import Sobol
from dse.loading.extensions import SamplerSection
from dse.storage.export.tables import to_csv
from dse.storage.folder import StudyFolder

NAMES = ("a", "b")
BISECTION = Bisection(requirement="R1", width=0.002)
BOUNDARY = Boundary(samples=28, first=6, batch=5)
HALF = 11  # of the runs of the smaller study


def test_a_sampler_that_looks_at_results_closes_in_on_a_boundary(tmp_path: Path) -> None:
    run(tmp_path, study_of(BISECTION))
    with StudyFolder.open(tmp_path) as folder:
        table = folder.table()
        passes = table.margins("R1") >= 0
        x = table.points["part.x0"]
    # A pass and a failure that are no further apart than asked for.
    assert x[passes].min() - x[~passes].max() <= 0.002 or x[~passes].min() - x[passes].max() <= 0.002


def run(path: Path, study: Study, workers: int = 1, names: tuple[str, ...] = NAMES, **mischief: Any) -> Explored:
    with StudyFolder.resume(path, definition_of(study, names)) as folder:
        return explore(
            study, benches(*names, **mischief), folder, executor=Local(workers=workers), make_runner=make_fake
        )


def content(path: Path) -> tuple[bytes, dict[str, bytes], StudyDefinition]:
    with StudyFolder.open(path) as folder:
        files = {file.name: file.read_bytes() for file in folder.waveform_folder.iterdir()}
        return to_csv(folder), files, folder.header.definition


def points(path: Path) -> dict[int, tuple[str, tuple[float, ...]]]:
    with StudyFolder.open(path) as folder:
        return {
            run.request.number: (run.request.configuration, tuple(map(float, run.request.point.values())))
            for run in folder.table().runs()
        }


@pytest.mark.thorough
@pytest.mark.parametrize("keep", [Keep.ALL, Keep.NEAR_BOUNDARY])
@pytest.mark.sampled(2)
def test_one_worker_and_two_make_the_same_study_of_a_sampler_that_looks_at_results(tmp_path: Path, keep: Keep) -> None:
    study = study_of(BISECTION, keep=keep)
    one = run(tmp_path / "one", study)
    two = run(tmp_path / "two", study, workers=2)
    assert one == two
    assert content(tmp_path / "one") == content(tmp_path / "two")


@pytest.mark.thorough
def test_a_finished_study_of_such_a_sampler_is_left_as_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = study_of(BISECTION, keep=Keep.ALL)
    first, before = run(tmp_path, study), content(tmp_path)

    def refuse(*_: object) -> None:
        raise AssertionError("a worker was started")

    monkeypatch.setattr("dse.exploration.supervision.supervisor.WorkerProcess", refuse)
    assert run(tmp_path, study) == replace(first, before=first.runs, simulated=0)
    assert content(tmp_path) == before


SCRIPT = """
import sys
from pathlib import Path
sys.path[:0] = {paths!r}
import test_growing
from test_growing import run, study_of
from dse.domain.study import Keep
study = study_of(test_growing.{sampler}, keep=Keep({keep!r}))
run(Path({folder!r}), study, workers={workers}, seconds={seconds})
"""


def runs_in(folder: Path) -> int:
    if not (folder / "study.sqlite").exists():
        return 0
    with StudyFolder.open(folder) as opened:
        return len(opened.finished())


def killed_on_the_way(folder: Path, keep: Keep, sampler: str, workers: int, kills: int, seconds: float) -> int:
    """Explore into *folder*, killed with all workers *kills* times at random moments; how often it was alive then."""
    here = Path(__file__).parent
    script = folder.with_suffix(".py")
    paths = [str(here), str(here.parent), str(here.parents[1]), str(here.parents[1] / "examples" / "plugin")]
    text = SCRIPT.format(
        paths=paths, folder=str(folder), keep=str(keep), sampler=sampler, workers=workers, seconds=seconds
    )
    script.write_text(text, encoding="utf-8")
    moments = random.Random(f"{keep} {workers}")  # noqa: S311  # no secret
    alive = 0
    for _ in range(kills):
        # What a killed process leaves in the folder for temporary files stays with the test.
        process = subprocess.Popen(
            [sys.executable, str(script)], start_new_session=True, env={**os.environ, "TMPDIR": str(folder.parent)}
        )
        # From the first import to some runs on; however fast the machine, not the whole study before the last kill.
        wanted = runs_in(folder) + moments.randint(0, -(-HALF // kills))
        while runs_in(folder) < wanted and process.poll() is None:
            time.sleep(0.01)
        time.sleep(moments.uniform(0, seconds / 4 if wanted else 0.5))
        alive += process.poll() is None
        os.killpg(process.pid, signal.SIGKILL) if process.poll() is None else None
        process.wait()
    return alive


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform == "win32", reason="process groups")
@pytest.mark.parametrize(
    ("sampler", "workers", "kills", "seconds"),
    [
        ("BISECTION", 2, 4, 0.05),
        # A run takes so long that the study is not done before the last kill.
        pytest.param("BOUNDARY", 1, 8, 0.4, marks=pytest.mark.thorough),
        pytest.param("BOUNDARY", 1, 20, 0.4, marks=pytest.mark.nightly),
        pytest.param("BISECTION", 1, 20, 0.4, marks=pytest.mark.nightly),
        pytest.param("BISECTION", 2, 20, 0.8, marks=pytest.mark.nightly),
        pytest.param("BOUNDARY", 2, 20, 0.8, marks=pytest.mark.nightly),
    ],
)
def test_killed_at_random_moments_it_ends_with_the_same_bytes(
    tmp_path: Path, sampler: str, workers: int, kills: int, seconds: float
) -> None:
    keep = Keep.ALL if workers == 1 else Keep.NEAR_BOUNDARY
    alive = killed_on_the_way(tmp_path / "killed", keep, sampler, workers, kills, seconds)
    study = study_of({"BISECTION": BISECTION, "BOUNDARY": BOUNDARY}[sampler], keep=keep)
    summary = run(tmp_path / "killed", study, workers=workers)
    assert summary.irreproducible == 0
    run(tmp_path / "whole", study)
    assert content(tmp_path / "killed") == content(tmp_path / "whole")
    assert alive >= kills * 3 // 4


class Obstinate(SamplerSection):
    """Asks for *points* of configuration a, an ask each; with *restless* for others each time it is started."""

    name: ClassVar[str] = "obstinate"
    once: ClassVar[bool] = False
    grid: ClassVar[None] = None

    asked: list[list[float]]
    configuration: str = "a"
    restless: bool = False

    def start(self, brief: Brief) -> Any:
        return _Obstinate(self)


class _Obstinate:
    started = 0

    def __init__(self, sampler: Obstinate) -> None:
        self.left = list(sampler.asked)
        self.configuration = sampler.configuration
        type(self).started += 1
        self.shift = self.started / 1000 if sampler.restless else 0.0

    def ask(self) -> Sequence[Candidate]:
        if not self.left:
            return []
        return [Candidate(self.configuration, tuple(value + self.shift for value in self.left.pop(0)))]

    def tell(self, outcomes: object) -> None:
        pass


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"asked": [[0.5, 1.5]]}, r"'obstinate' asks for part\.x1 = 1\.5, outside of its range 0\.0 … 1\.0"),
        ({"asked": [[0.5]]}, "asks for a point of 1 values for 2 variables"),
        ({"asked": [[0.5, 0.5]], "configuration": "z"}, "asks for the configuration 'z', which is not explored"),
        ({"asked": []}, "asks for no run at all"),
        ({"asked": [[0.5, 0.5]] * 200}, "asked 101 times in a row for runs that are there"),
    ],
)
def test_a_sampler_that_asks_for_what_no_study_can_have_is_named(
    tmp_path: Path, options: dict[str, Any], told: str
) -> None:
    with pytest.raises(DseError, match=told):
        run(tmp_path, study_of(Obstinate(**options)))


def test_a_sampler_that_asks_otherwise_when_it_is_asked_again_is_named(tmp_path: Path) -> None:
    study = study_of(Obstinate(asked=[[0.1, 0.1], [0.2, 0.2]], restless=True))
    run(tmp_path, study)
    with pytest.raises(DseError, match=r"asks for another run 0 than it did before[\s\S]*--fresh"):
        run(tmp_path, study)


def test_a_run_that_is_asked_for_again_is_told_again_and_not_made_again(tmp_path: Path) -> None:
    summary = run(tmp_path, study_of(Obstinate(asked=[[0.1, 0.1], [0.2, 0.2], [0.1, 0.1]])))
    assert (summary.runs, summary.simulated) == (2, 2)


@pytest.mark.thorough
@pytest.mark.parametrize("keep", [Keep.ALL, pytest.param(Keep.NEAR_BOUNDARY, marks=pytest.mark.thorough)])
@pytest.mark.parametrize(
    ("before", "after", "new"),
    [
        (study_of(levels=3), study_of(levels=5), 25 - 9),
        (study_of(Sobol(samples=8)), study_of(Sobol(samples=20)), 12),
        (study_of(LatinHypercube(samples=10)), study_of(LatinHypercube(samples=25)), 15),
        (study_of(levels=3), study_of(Sobol(samples=5)), 5),
    ],
    ids=["more levels", "more of a sequence", "more of a hypercube", "another sampler"],
)
def test_an_extended_study_keeps_its_runs_and_makes_only_what_is_new(
    tmp_path: Path, keep: Keep, before: Study, after: Study, new: int
) -> None:
    run(tmp_path, replace(before, keep=Keep.NONE))
    there = points(tmp_path)
    summary = run(tmp_path, replace(after, keep=keep), workers=2)
    now = points(tmp_path)
    assert len(now) == len(there) + len(NAMES) * new == summary.runs
    assert {number: now[number] for number in there} == there
    assert len(set(now.values())) == len(now)
    if keep is not Keep.ALL:
        assert summary.simulated == len(NAMES) * new + summary.kept
    run(tmp_path, replace(after, keep=keep))
    assert points(tmp_path) == now


@pytest.mark.thorough
def test_an_extended_study_is_the_same_on_one_worker_and_two_and_after_it_was_stopped(tmp_path: Path) -> None:
    first, second = study_of(levels=5, keep=Keep.ALL), study_of(BISECTION, keep=Keep.ALL)
    for name, workers in (("one", 1), ("two", 2)):
        run(tmp_path / name, first, workers)
        run(tmp_path / name, second, workers)
    assert content(tmp_path / "one") == content(tmp_path / "two")
    run(tmp_path / "stopped", first)
    told = 0

    def stop(_: object) -> None:
        nonlocal told
        told += 1
        if told == 3:
            raise KeyboardInterrupt

    with (
        StudyFolder.resume(tmp_path / "stopped", definition_of(second, NAMES)) as folder,
        pytest.raises(KeyboardInterrupt),
    ):
        explore(
            second,
            benches(*NAMES, seconds=0.05),
            folder,
            executor=Local(workers=2),
            make_runner=make_fake,
            on_progress=stop,
        )
    run(tmp_path / "stopped", second)
    assert content(tmp_path / "stopped") == content(tmp_path / "one")


@pytest.mark.thorough
def test_a_study_that_was_extended_before_it_was_complete_goes_on_with_what_is_there(tmp_path: Path) -> None:
    small, large = study_of(levels=6, variables=1), study_of(levels=11, variables=1)
    with StudyFolder.create(tmp_path, definition_of(small, NAMES)) as folder:
        explore(small, benches(*NAMES), folder, executor=Local(workers=1), make_runner=make_fake)
        # As if it had been stopped after four runs.
        folder._connection.execute("DELETE FROM runs WHERE number >= 4")
    summary = run(tmp_path, large)
    assert summary.runs == 22
    with StudyFolder.open(tmp_path) as folder:
        assert folder.header.runs == 22
        assert folder.header.numbers == 12 + 18
        assert folder.header.slices == ()


@pytest.mark.thorough
def test_runs_beside_the_grid_are_interpolated_as_points_that_lie_anywhere(tmp_path: Path) -> None:
    run(tmp_path, study_of(levels=3))
    with StudyFolder.open(tmp_path) as folder:
        assert folder.header.slices == ()
    run(tmp_path, study_of(levels=4, keep=Keep.NEAR_BOUNDARY))
    with StudyFolder.open(tmp_path) as folder:
        # The middle level of three is none of four.
        assert folder.header.slices is None
        assert folder.header.runs - folder.header.asked == len(NAMES) * 5


@pytest.mark.thorough
def test_configurations_can_be_added_and_those_left_out_keep_their_runs(tmp_path: Path) -> None:
    study = study_of(levels=3, keep=Keep.NEAR_BOUNDARY)
    run(tmp_path, study, names=("a", "b"))
    summary = run(tmp_path, study, names=("b", "c"))
    assert summary.runs == 27
    with StudyFolder.open(tmp_path) as folder:
        assert set(folder.table().configurations) == {"a", "b", "c"}
        assert folder.header.configurations == ("b", "c", "a")


@pytest.mark.thorough
def test_a_study_of_the_first_version_opens_goes_on_and_is_extended(tmp_path: Path) -> None:
    study = study_of(levels=4, keep=Keep.ALL)
    run(tmp_path / "new", study)
    run(tmp_path / "old", study)
    make_first_version(tmp_path / "old")
    with StudyFolder.open(tmp_path / "old") as folder:
        assert (folder.header.runs, folder.header.asked, folder.header.slices) == (32, 32, ())
        assert len(folder.table()) == 32
        assert folder.run(7).waveforms is not None
    assert run(tmp_path / "old", study).simulated == 0
    assert content(tmp_path / "old") == content(tmp_path / "new")
    for name in ("old", "new"):
        run(tmp_path / name, study_of(levels=7, keep=Keep.ALL))
    assert content(tmp_path / "old") == content(tmp_path / "new")


def make_first_version(path: Path) -> None:
    """Turn the study in *path*, which was never extended, into what version 1 wrote."""
    import json
    import sqlite3
    from contextlib import closing

    with closing(sqlite3.connect(path / "study.sqlite")) as connection:
        facts = {key: json.loads(value) for key, value in connection.execute("SELECT key, value FROM facts")}
        definition = facts["definition"]
        del definition["explored"]
        definition["format"] = 1
        sampler = definition["sampler"]
        definition["sampler"] = {"kind": sampler["kind"], **sampler["options"]}
        for configuration in definition["configurations"]:
            configuration["start"] = {name: list(start.items()) for name, start in configuration["start"].items()}
        connection.execute("DELETE FROM facts")
        old = {"definition": definition, "fingerprint": "0123", "runs": facts["runs"]}
        connection.executemany("INSERT INTO facts VALUES (?, ?)", [(k, json.dumps(v)) for k, v in old.items()])
        connection.execute("CREATE TABLE timing (number INTEGER PRIMARY KEY, wall REAL) STRICT")
        connection.execute("INSERT OR IGNORE INTO timing SELECT run, seconds FROM attempts")
        for table in ("asks", "attempts", "makers", "files", "checks"):
            connection.execute(f"DROP TABLE {table}")
        for table in ("runs", "kept"):
            connection.execute(f"ALTER TABLE {table} DROP COLUMN seal")
        connection.execute("PRAGMA user_version = 1")
        connection.commit()


@pytest.mark.thorough
def test_the_points_of_a_factorial_that_is_refined_twice_as_fine_are_on_the_new_grid(tmp_path: Path) -> None:
    run(tmp_path, study_of(FullFactorial(slices=[["part.x0"], ["part.x1"]]), levels=3))
    run(tmp_path, study_of(FullFactorial(slices=[["part.x0"], ["part.x1"]]), levels=5))
    with StudyFolder.open(tmp_path) as folder:
        assert folder.header.slices == (("part.x0",), ("part.x1",))
        assert np.isin([0.0, 0.25, 0.5, 0.75, 1.0], folder.table().points["part.x0"]).all()
