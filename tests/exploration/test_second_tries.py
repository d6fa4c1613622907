"""What the environment does to a run, or a run before it, is never the verdict on it: it is tried once more."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from fake_runners import FakeBench, benches, definition_of, make_fake, study_of
from test_worn_workers import explored

from dse.domain.run import Outcome
from dse.domain.study import Keep
from dse.exploration.executors.local import Local
from dse.exploration.loop import explore
from dse.exploration.supervision.process_state import ProcessState
from dse.storage import StudyFolder

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals, limits")
linux = pytest.mark.skipif(sys.platform != "linux", reason="/proc")


@pytest.mark.thorough
@pytest.mark.parametrize("mischief", ["crashes", "hangs", "exits", "raises", "is stopped", "is killed"])
@pytest.mark.sampled(6)
def test_what_happens_once_is_no_verdict(tmp_path: Path, mischief: str) -> None:
    timeout = 0.5 if mischief in ("hangs", "is stopped") else 60.0
    bench = FakeBench("a", mischief, (7,), timeout=timeout, file=tmp_path / "happened")
    summary, failures, _ = explored(tmp_path / "study", study_of(), bench)
    assert failures == {}
    assert (summary.retried, summary.simulated) == (1, 25)


@pytest.mark.thorough
def test_signals_that_ask_a_worker_to_end_are_for_the_supervisor(tmp_path: Path) -> None:
    bench = FakeBench("a", "terminates", (7,))
    summary, failures, _ = explored(tmp_path, study_of(), bench)
    assert (failures, summary.retried) == ({}, 0)


@linux
@pytest.mark.parametrize("mischief", ["lowers a limit", "lowers a limit for good", "catches signals"])
@pytest.mark.sampled(3)
def test_what_poisons_a_process_retires_it_and_harms_no_later_run(
    tmp_path: Path, mischief: str, few_files: None
) -> None:
    bench = FakeBench("a", mischief, (7,))
    _, failures, _ = explored(tmp_path, study_of(), bench)
    assert failures == {}


@linux
@pytest.mark.thorough
def test_a_thread_that_aborts_later_costs_no_innocent_run(tmp_path: Path) -> None:
    bench = FakeBench("a", "aborts later", (2,), seconds=0.05)
    summary, failures, _ = explored(tmp_path, study_of(), bench)
    assert failures == {}
    assert summary.retried == 1


@pytest.mark.thorough
def test_a_configuration_that_cannot_be_loaded_once_is_loaded_again(tmp_path: Path) -> None:
    bench = FakeBench("a", "cannot be loaded once", file=tmp_path / "happened")
    _, failures, _ = explored(tmp_path / "study", study_of(), bench)
    assert failures == {}


@pytest.mark.thorough
def test_a_deleted_folder_ends_no_worker(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    here.rmdir()
    study = study_of()
    summary, failures, _ = explored(tmp_path / "study", study, FakeBench("a", "crashes", (3,)))
    assert set(failures) == {3}
    assert summary.runs == 25


def test_a_run_that_loses_its_folder_harms_none(tmp_path: Path) -> None:
    _, failures, _ = explored(tmp_path / "study", study_of(), FakeBench("a", "loses its folder", (3, 4)))
    assert failures == {}


def test_what_the_first_run_changes_is_harm_to_other_configurations_only() -> None:
    state = ProcessState()
    state.begin(1e12)
    before = signal.signal(signal.SIGUSR1, lambda *_: None)
    try:
        assert state.harm(now=True) == ""
        assert state.harm(now=True) == ""
        if sys.platform == "linux":
            assert state.is_marked
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGUSR2})
            assert state.harm(now=True) == "signals are handled in another way"
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGUSR2})
        signal.signal(signal.SIGUSR1, before)


SCRIPT = """
import sys
from pathlib import Path
sys.path[:0] = {paths!r}
from test_worn_workers import explored
from fake_runners import FakeBench, study_of
{before}
print(explored(Path({folder!r}), study_of(levels=2), FakeBench("a", seconds=0.6, timeout=1.5), runs=4)[1])
"""


@linux
@pytest.mark.thorough
def test_time_in_which_all_were_stopped_does_not_count(tmp_path: Path) -> None:
    process = running(tmp_path, tmp_path / "study")
    group = [psutil.Process(process.pid)]
    while not any("spawn_main" in " ".join(child.cmdline()) for child in group[0].children(recursive=True)):
        time.sleep(0.01)
    time.sleep(1.0)
    os.killpg(process.pid, signal.SIGSTOP)
    time.sleep(3.0)
    os.killpg(process.pid, signal.SIGCONT)
    assert process.communicate(timeout=60)[0].strip() == "{}"


def running(folder: Path, study: Path, before: str = "") -> subprocess.Popen[str]:
    here = Path(__file__).parent
    script = folder / "script.py"
    paths = [str(here), str(here.parent), str(here.parents[1])]
    script.write_text(SCRIPT.format(paths=paths, folder=str(study), before=before), encoding="utf-8")
    return subprocess.Popen([sys.executable, str(script)], start_new_session=True, stdout=subprocess.PIPE, text=True)


NAMES = ("types", "struct", "socket", "enum", "re", "random", "tempfile", "pickle", "numpy")


@pytest.mark.thorough
def test_modules_in_the_current_folder_are_not_run_by_workers(tmp_path: Path) -> None:
    here = tmp_path / "here"
    here.mkdir()
    for name in NAMES:
        (here / f"{name}.py").write_text(f"open({str(tmp_path / 'run')!r}, 'a').write(__name__)\nraise SystemExit(9)")
    process = running(tmp_path, tmp_path / "study", f"import os; os.chdir({str(here)!r}); sys.path.insert(0, '')")
    assert process.communicate(timeout=60)[0].strip() == "{}"
    assert not (tmp_path / "run").exists()


@pytest.mark.thorough
def test_a_configuration_whose_loading_fails_in_each_process_fails_alone(tmp_path: Path) -> None:
    study = study_of(levels=2)
    with StudyFolder.create(tmp_path, definition_of(study, ("a", "b"))) as folder:
        prepared = {**benches("a", mischief="dies loading"), **benches("b")}
        explore(study, prepared, folder, executor=Local(workers=2), make_runner=make_fake)
        outcomes = [run.outcome for run in folder.table().runs()]
    assert outcomes == [Outcome.FAILED] * 4 + [Outcome.DONE] * 4


@linux
@pytest.mark.thorough
def test_a_leak_with_waveforms_makes_no_run_a_culprit(tmp_path: Path) -> None:
    bench = FakeBench("a", "leaks", memory=200e6 + 400e6, seconds=0.02)
    _, failures, kept = explored(tmp_path, study_of(levels=4, keep=Keep.ALL), bench, runs=16)
    assert failures == {}
    assert all(kept[number] for number in range(16))


@linux
@pytest.mark.thorough
def test_memory_that_is_locked_and_never_freed_ends_in_a_table(tmp_path: Path) -> None:
    bench = FakeBench("a", "locks and leaks", memory=200e6 + 400e6, seconds=0.02)
    _, failures, _ = explored(tmp_path, study_of(levels=4), bench, runs=16)
    assert failures == {}
    with StudyFolder.open(tmp_path) as folder:
        assert len({each.maker for each in folder.attempts()}) <= 16  # never more processes than runs


@pytest.mark.thorough
@pytest.mark.parametrize("keep", [Keep.NONE, Keep.ALL])
def test_a_killed_worker_costs_the_run_at_hand_and_no_other(tmp_path: Path, keep: Keep) -> None:
    # Chunks have several runs, of which some were made when the worker is killed.
    bench = FakeBench("a", "is killed", (11,), file=tmp_path / "happened")
    study, runs = study_of(levels=16, keep=keep), 256
    summary, failures, kept = explored(tmp_path / "study", study, bench, runs=runs)
    assert failures == {}
    assert summary.simulated == runs
    with StudyFolder.open(tmp_path / "study") as folder:
        tries = folder.attempts()
        files = sorted({*kept.values()})
    assert sorted(each.run for each in tries if not each.cause) == sorted([*range(runs), 32, 96, 160, 224])  # repeated
    assert [(each.run, each.cause) for each in tries if each.cause] == [
        (11, "killed from outside (signal 9) in fake: fmi2DoStep of run 11")
    ]
    explored(tmp_path / "whole", study, FakeBench("a"), runs=runs)
    for file in files:
        assert (tmp_path / "study/waveforms" / file).read_bytes() == (tmp_path / "whole/waveforms" / file).read_bytes()
    assert not (tmp_path / "study" / "spool").exists()


@pytest.mark.thorough
def test_runs_that_failed_are_made_again_on_demand(tmp_path: Path) -> None:
    study = study_of()
    explored(tmp_path, study, FakeBench("a", "fails", (7, 8)))
    with StudyFolder.resume(tmp_path, definition_of(study)) as folder:
        folder.forget(folder.failed())
        prepared = {"a": FakeBench("a", "crashes", (8,))}
        summary = explore(study, prepared, folder, executor=Local(workers=1), make_runner=make_fake)
        assert (summary.simulated, summary.new, folder.failed()) == (2, 2, {8})
        assert [folder.causes()[number] for number in folder.causes()] == [
            "crashed (signal 11) in fake: fmi2DoStep of run 8"
        ]
