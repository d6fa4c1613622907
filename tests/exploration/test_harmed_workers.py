"""What a run does to its process costs this run at most: never another one, and never the study."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

import pytest
from fake_runners import FakeBench, definition_of, make_fake, study_of
from test_worn_workers import explored

from dse.domain.run import Outcome
from dse.domain.study import Keep
from dse.exploration.executors.local import Local
from dse.exploration.loop import explore
from dse.exploration.supervision.process_state import ProcessState
from dse.storage.folder import StudyFolder

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="forks, signals, limits")

BOTH = pytest.mark.parametrize("keep", [Keep.NONE, Keep.ALL])


@pytest.mark.parametrize(("keep", "threads"), [(Keep.NONE, 1), (Keep.ALL, 2)])
@pytest.mark.thorough
def test_a_process_that_makes_a_copy_of_itself_stays_one_worker(tmp_path: Path, keep: Keep, threads: int) -> None:
    bench = FakeBench("a", "forks", (7, 40, 41), seconds=0.0005)
    study = study_of(levels=50, keep=keep)
    summary, failures, kept = explored(tmp_path, study, bench, runs=2500, threads=threads)
    assert failures == {}
    assert (summary.simulated, summary.irreproducible, summary.kept) == (2500, 0, len(kept))


@pytest.mark.thorough
@pytest.mark.sampled(4)
@BOTH
@pytest.mark.parametrize("levels", [5, 50])
def test_what_a_run_writes_where_it_must_not_harms_none(tmp_path: Path, keep: Keep, levels: int) -> None:
    # 2,500 runs make chunks of 32, in which it shows only later that something was written.
    bench = FakeBench("a", "scribbles", (7, 20), timeout=5)
    summary, failures, kept = explored(tmp_path, study_of(levels=levels, keep=keep), bench, runs=levels**2)
    assert failures == {}
    assert (summary.irreproducible, summary.simulated, summary.retried) == (0, levels**2, 0)
    if keep is Keep.ALL:
        assert all(kept[number] for number in range(levels**2))


@pytest.mark.thorough
def test_nobody_waits_for_the_rest_of_a_message(tmp_path: Path) -> None:
    bench = FakeBench("a", "stops in a message", (7,), timeout=2)
    _, failures, _ = explored(tmp_path, study_of(), bench)
    assert failures == {7: "stopped by a signal for 2 s in fake: fmi2DoStep of run 7"}


@pytest.mark.parametrize(
    ("mischief", "levels", "keep"),
    [
        ("leaks files", 5, Keep.NONE),
        ("leaks files", 50, Keep.ALL),
        ("leaves no file to open", 5, Keep.ALL),
        ("leaves no file to open", 50, Keep.NONE),
    ],
)
@pytest.mark.thorough
def test_runs_that_leave_files_open_have_their_worker_renewed_and_none_is_blamed(
    tmp_path: Path, keep: Keep, mischief: str, levels: int, few_files: None
) -> None:
    # Each of many leaves 20 files open, or one of them all there can be.
    bench = FakeBench("a", mischief, tuple(range(64)) if mischief == "leaks files" else (7,))
    runs = levels**2
    summary, failures, kept = explored(tmp_path, study_of(levels=levels, keep=keep), bench, runs=runs)
    assert failures == {}
    assert (summary.irreproducible, summary.retried) == (0, 0)
    if keep is Keep.ALL:
        assert all(kept[number] for number in range(runs))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("levels", [5, 50])
def test_a_run_that_lowers_the_limit_for_files_harms_none_and_itself_neither(
    tmp_path: Path, levels: int, few_files: None
) -> None:
    bench = FakeBench("a", "leaves few files to write", (7,))
    study = study_of(levels=levels, keep=Keep.ALL)
    summary, failures, kept = explored(tmp_path, study, bench, runs=levels**2)
    assert failures == {}
    assert summary.irreproducible == 0
    assert all(kept[number] for number in range(levels**2))


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("threads", [1, 2])
def test_a_run_that_fails_as_others_have_used_up_all_files_is_made_again(
    tmp_path: Path, few_files: None, threads: int
) -> None:
    # Run 7 is a good one and leaves no file to open, of which the ones after it die: in a process of their own.
    bench = FakeBench("a", "fails after a greedy one", (7,))
    _, failures, _ = explored(tmp_path, study_of(levels=50), bench, runs=2500, threads=threads)
    assert failures == {}


@pytest.mark.thorough
def test_a_configuration_that_cannot_be_loaded_as_files_are_used_up_is_loaded_by_another_process(
    tmp_path: Path, few_files: None
) -> None:
    study = study_of(levels=2)
    with StudyFolder.create(tmp_path, definition_of(study, ("a", "b"))) as folder:
        prepared = {"a": FakeBench("a", "leaves no file to open", (3,)), "b": FakeBench("b")}
        explore(study, prepared, folder, executor=Local(workers=1), make_runner=make_fake)
        assert [run.outcome for run in folder.table().runs()] == [Outcome.DONE] * 8


def test_what_a_run_changes_for_new_files_is_put_back() -> None:
    before = os.umask(0o022)
    try:
        surroundings = ProcessState()
        os.umask(0o777)
        surroundings.restore()
        assert os.umask(0o022) == 0o022
    finally:
        os.umask(before)


@pytest.mark.parametrize("timer", [signal.ITIMER_REAL, signal.ITIMER_VIRTUAL, signal.ITIMER_PROF])
def test_an_alarm_does_not_outlast_the_run_that_set_it(timer: int) -> None:
    surroundings = ProcessState()
    signal.setitimer(timer, 100.0, 100.0)
    assert surroundings.harm(now=True) == ""
    assert signal.getitimer(timer) == (0.0, 0.0)
