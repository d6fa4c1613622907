"""Runs near a boundary are made again with finer numerics; here by fakes whose error bars are known."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fake_runners import REQUIREMENTS, benches, definition_of, make_check, make_fake, study_of

from dse.domain.study import Study
from dse.exploration import Checkable, FuturesExecutor, KnownRuns, check_measures, check_near_boundary, explore
from dse.exploration.executor import Executor
from dse.exploration.executors.local import Local
from dse.exploration.near_boundary import near_boundary
from dse.exploration.samplers.latin_hypercube import LatinHypercube
from dse.storage import CERTAINTIES, EXPORTS, RunStore, StudyFolder

NAMES = ("a", "b")


def study() -> Study:
    return study_of(LatinHypercube(samples=100))


@pytest.fixture(scope="module")
def explored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The study, explored and not checked. Tests copy it."""
    path = tmp_path_factory.mktemp("explored")
    with StudyFolder.resume(path, definition_of(study(), NAMES)) as folder:
        explore(study(), benches(*NAMES), folder, executor=Local(workers=1), make_runner=make_fake)
    return path


def check(path: Path, executor: Executor | None = None, known: KnownRuns | None = None, **mischief: Any) -> set[str]:
    """Check the study in *path*; the configurations that had to be got ready for it."""
    asked: set[str] = set()

    def checkable(names: Any) -> Checkable:
        asked.update(names)
        return Checkable(benches(*names, **mischief), *([known] if known else []))

    with StudyFolder.resume(path, definition_of(study(), NAMES)) as folder:
        check_near_boundary(
            study(), {*NAMES}, folder, checkable, executor=executor or Local(workers=1), make_runner=make_check
        )
    return asked


def content(path: Path) -> list[bytes]:
    with StudyFolder.open(path) as folder:
        return [export(folder) for export in EXPORTS.values()]


@pytest.mark.thorough
def test_of_two_hundred_runs_those_near_the_boundary_are_checked_and_no_others(explored: Path, tmp_path: Path) -> None:
    shutil.copytree(explored, tmp_path, dirs_exist_ok=True)
    check(tmp_path)
    with StudyFolder.open(tmp_path) as folder:
        table = folder.table()
        near = near_boundary(study(), table, None)
        assert len(table) == 200
    margins = table.margins("R1")
    # All errors may be 0.1; the run with the smallest margin has a neighbour on the other side.
    small = set(table.numbers[np.abs(margins) <= 0.1].tolist())
    assert set(table.checks.numbers.tolist()) == near | small
    assert len(table.checks) < 100
    certainty = np.array(CERTAINTIES)[table.certainties("R1")]
    flips, checked = (margins > 0.0) & (margins < 0.15), np.isin(table.numbers, table.checks.numbers)
    assert (certainty[~checked] == "").all()
    assert (certainty[checked & ((np.abs(margins) <= 0.1) | flips)] == "doubtful").all()
    assert (certainty[checked & (np.abs(margins) > 0.1) & ~flips] == "certain").all()
    assert set(certainty[checked]) == {"certain", "doubtful"}
    # A variation that comes to a verdict casts doubt on "not exercised" as well.
    assert set(np.array(CERTAINTIES)[table.certainties("R2")][checked & flips]) == {"doubtful"}
    assert table.checks.problems == {
        n: "with half the step: bumpy" for n in table.checks.numbers.tolist() if n % 7 == 0
    }


@pytest.mark.thorough
def test_what_is_checked_is_not_checked_again_and_no_worker_is_started(
    explored: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(explored, tmp_path, dirs_exist_ok=True)
    check(tmp_path)
    before = content(tmp_path)

    def refuse(*_: object) -> None:
        raise AssertionError("a worker was started")

    monkeypatch.setattr("dse.exploration.supervision.supervisor.WorkerProcess", refuse)
    assert not check(tmp_path)
    assert content(tmp_path) == before


@pytest.mark.thorough
def test_a_study_without_any_boundary_has_the_run_nearest_to_the_bound_checked(tmp_path: Path) -> None:
    # A line: only R1's margin, 1 - x, is judged, and it is never negative.
    line = study_of(LatinHypercube(samples=30), variables=1)
    with StudyFolder.resume(tmp_path, definition_of(line, ("a",))) as folder:
        explore(line, benches("a"), folder, executor=Local(workers=1), make_runner=make_fake)
        count = check_near_boundary(
            line, {"a"}, folder, lambda n: Checkable(benches(*n)), executor=Local(workers=1), make_runner=make_check
        )
        table = folder.table()
    assert count == len(table.checks)
    assert int(table.numbers[np.argmin(table.margins("R1"))]) in table.checks.numbers
    assert (np.abs(table.margins("R1")[table.checks.numbers]) <= 0.1).all()


@pytest.mark.thorough
def test_many_workers_other_executors_and_known_runs_give_the_same_bytes(explored: Path, tmp_path: Path) -> None:
    from concurrent.futures import ThreadPoolExecutor

    from test_known_runs import address

    expected = []
    for name in ("one", "two", "pool", "first", "known"):
        shutil.copytree(explored, tmp_path / name)
    check(tmp_path / "one")
    expected = content(tmp_path / "one")
    check(tmp_path / "two", executor=Local(workers=2))
    with ThreadPoolExecutor(2) as pool:
        check(tmp_path / "pool", executor=FuturesExecutor(pool))
    measures = check_measures(definition_measures())
    for name in ("first", "known"):
        store = RunStore(tmp_path / "runs")
        known = KnownRuns(store, {each: address(each) for each in NAMES}, measures, {})
        # What is known is not made: the second time every run would kill its worker.
        check(tmp_path / name, known=known, mischief="exits" if name == "known" else "", when=tuple(range(200)))
    for name in ("two", "pool", "first", "known"):
        assert content(tmp_path / name) == expected, name


def definition_measures() -> Any:
    from dse.storage import StudyHeader

    return StudyHeader(definition_of(study(), NAMES)).measures


@pytest.mark.parametrize(
    ("mischief", "said"),
    [
        ("fails", "world: fmi2DoStep at t = 3.21 s returned error"),
        ("drifts otherwise", "not reproducible: simulated again it gave another result"),
    ],
)
def test_a_check_that_fails_or_gives_another_run_is_told_and_leaves_doubt(
    explored: Path, tmp_path: Path, mischief: str, said: str
) -> None:
    shutil.copytree(explored, tmp_path, dirs_exist_ok=True)
    check(tmp_path, mischief=mischief, when=tuple(range(200)))
    with StudyFolder.open(tmp_path) as folder:
        table = folder.table()
    assert len(table.checks) > 20
    assert set(table.checks.problems.values()) == {said}
    for requirement in REQUIREMENTS:
        words = np.array(CERTAINTIES)[table.certainties(requirement)]
        assert set(words[np.isin(table.numbers, table.checks.numbers)]) == {"doubtful"}


KILLED = """\
import sys
sys.path[:0] = {paths}
from pathlib import Path
from test_boundary_checks import check
check(Path({folder!r}), seconds=0.03)
"""


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform == "win32", reason="process groups")
def test_killed_at_once_with_all_its_workers_it_goes_on_and_gives_the_same_bytes(
    explored: Path, tmp_path: Path
) -> None:
    for name in ("killed", "whole"):
        shutil.copytree(explored, tmp_path / name)
    here = Path(__file__).parent
    script = tmp_path / "script.py"
    paths = [str(here), str(here.parent), str(here.parents[1])]
    script.write_text(KILLED.format(paths=paths, folder=str(tmp_path / "killed")), encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, str(script)], start_new_session=True, env={**os.environ, "TMPDIR": str(tmp_path)}
    )
    try:
        wait_for_checks(tmp_path / "killed", 5)
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    there = checks_of(tmp_path / "killed")
    check(tmp_path / "whole")
    assert 5 <= there < checks_of(tmp_path / "whole")
    check(tmp_path / "killed")
    assert content(tmp_path / "killed") == content(tmp_path / "whole")


def checks_of(path: Path) -> int:
    with StudyFolder.open(path) as folder:
        return len(folder.table().checks)


def wait_for_checks(path: Path, least: int) -> None:
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline:
        if checks_of(path) >= least:
            return
        time.sleep(0.02)
    raise AssertionError("the checks do not get on")
