from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from fake_runners import benches, definition_of, make_fake, study_of

from dse.domain.study import Keep, Study
from dse.errors import DseError
from dse.exploration.executors.local import Local
from dse.exploration.known_runs import forget_unsettled, unsettled
from dse.exploration.loop import ExplorationInterruptedError, Explored, explore
from dse.exploration.near_boundary import near_boundary
from dse.exploration.progress import Progress, Stage
from dse.exploration.samplers.full_factorial import FullFactorial
from dse.exploration.samplers.latin_hypercube import LatinHypercube
from dse.storage.export.tables import to_csv
from dse.storage.folder import StudyFolder

NAMES = ("a", "b")


def run(
    path: Path,
    study: Study,
    *,
    workers: int = 1,
    tell: Callable[[Progress], None] = lambda progress: None,
    **mischief: Any,
) -> Explored:
    with StudyFolder.resume(path, definition_of(study, NAMES)) as folder:
        return explore(
            study,
            benches(*NAMES, **mischief),
            folder,
            executor=Local(workers=workers),
            make_runner=make_fake,
            on_progress=tell,
        )


def test_an_executor_that_loses_runs_is_found_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("dse.exploration.supervision.supervisor.Supervisor.work_off", lambda *_: None)
    with pytest.raises(DseError, match="the executor 'local' ended without 50 of the runs that it was given"):
        run(tmp_path, study_of(levels=5))


def content(path: Path) -> tuple[bytes, dict[str, bytes]]:
    with StudyFolder.open(path) as folder:
        files = {file.name: file.read_bytes() for file in folder.waveform_folder.iterdir()}
        return to_csv(folder), files


@pytest.mark.thorough
@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("sampler", "keep"),
    [(FullFactorial(), Keep.ALL), (FullFactorial(), Keep.NONE), (LatinHypercube(samples=60), Keep.NEAR_BOUNDARY)],
    ids=["factorial, all kept", "factorial, none kept", "hypercube, kept near the boundary"],
)
def test_serial_and_parallel_give_the_same_bytes(tmp_path: Path, keep: Keep, sampler: Any) -> None:
    study = study_of(sampler, levels=8, keep=keep)
    run(tmp_path / "serial", study, workers=1, mischief="fails", when=(5,))
    run(tmp_path / "parallel", study, workers=2, mischief="fails", when=(5,))
    assert content(tmp_path / "serial") == content(tmp_path / "parallel")


def test_a_second_exploration_does_nothing_and_starts_no_worker(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = study_of(levels=8, keep=Keep.NEAR_BOUNDARY)
    first = run(tmp_path, study, mischief="fails", when=(5,))
    before = content(tmp_path)

    def refuse(*_: object) -> None:
        raise AssertionError("a worker was started")

    monkeypatch.setattr("dse.exploration.supervision.supervisor.WorkerProcess", refuse)
    second = run(tmp_path, study)
    assert second.simulated == 0
    assert (second.runs, second.failed, second.kept) == (first.runs, first.failed, first.kept)
    assert content(tmp_path) == before


@pytest.mark.thorough
def test_waveforms_near_the_boundary_are_kept_and_no_others(tmp_path: Path) -> None:
    study = study_of(levels=8, keep=Keep.NEAR_BOUNDARY)
    summary = run(tmp_path, study, workers=2)
    with StudyFolder.open(tmp_path) as folder:
        near = near_boundary(study, folder.table(), folder.header.slices)
        assert 0 < len(near) < 128
        assert set(folder.kept()) == near
        assert all(folder.waveforms(number) is not None for number in near)
        tries = folder.attempts()
        assert sorted(attempt.run for attempt in tries) == sorted([*range(128), *near])
        assert {attempt.cause for attempt in tries} == {""}
        assert 1 <= len({attempt.maker for attempt in tries}) <= 2
    assert summary.kept == len(near)
    assert summary.simulated == 128 + len(near)
    assert summary.irreproducible == 0


@pytest.mark.thorough
def test_damaged_waveforms_are_noticed_and_made_again(tmp_path: Path) -> None:
    study = study_of(levels=8, keep=Keep.NEAR_BOUNDARY)
    assert run(tmp_path, study).damaged == 0
    before = content(tmp_path)
    first, second, *_ = sorted((tmp_path / "waveforms").iterdir())
    with StudyFolder.open(tmp_path) as folder:
        harmed = sum(file in (first.name, second.name) for file in folder.kept().values())
    first.write_bytes(b"")
    second.write_bytes(second.read_bytes()[:-1] + b"x")
    summary = run(tmp_path, study)
    assert (summary.damaged, summary.again) == (harmed, harmed)
    assert content(tmp_path) == before
    assert run(tmp_path, study).damaged == 0


def test_runs_that_failed_and_are_made_again_leave_no_trace_in_what_is_kept(tmp_path: Path) -> None:
    study = study_of(levels=8, keep=Keep.NEAR_BOUNDARY)
    run(tmp_path / "undisturbed", study)
    with StudyFolder.open(tmp_path / "undisturbed") as folder:
        near = tuple(folder.kept())
    assert run(tmp_path / "disturbed", study, mischief="fails", when=near[::2]).failed == len(near[::2])
    assert content(tmp_path / "disturbed")[1].keys() - content(tmp_path / "undisturbed")[1].keys()
    with StudyFolder.resume(tmp_path / "disturbed", definition_of(study, NAMES)) as folder:
        forget_unsettled(folder, study)
    run(tmp_path / "disturbed", study)
    assert content(tmp_path / "disturbed") == content(tmp_path / "undisturbed")


@pytest.mark.thorough
def test_a_run_that_differs_when_simulated_again_is_reported(tmp_path: Path) -> None:
    study = study_of(levels=8, keep=Keep.NEAR_BOUNDARY)
    summary = run(tmp_path, study, mischief="drifts")
    with StudyFolder.open(tmp_path) as folder:
        told = {r.request.number for r in folder.table().runs() if r.problem.startswith("not reproducible")}
        # A drift of 1e-15 is lost in the larger sums, seen in the smaller ones.
        assert told
        assert told <= set(folder.kept())
    assert summary.irreproducible == len(told)
    assert run(tmp_path, study).simulated == 0
    with StudyFolder.resume(tmp_path, definition_of(study, NAMES)) as folder:
        assert unsettled(folder) == told
        folder.forget(told)
    assert run(tmp_path, study).new == len(told)
    with StudyFolder.open(tmp_path) as folder:
        assert not unsettled(folder)


@pytest.mark.thorough
def test_a_bench_is_a_study_without_variables(tmp_path: Path) -> None:
    summary = run(tmp_path, study_of(variables=0, keep=Keep.ALL), workers=2)
    assert (summary.runs, summary.kept) == (2, 2)


@pytest.mark.thorough
def test_progress_counts_what_was_there_and_ends_complete(tmp_path: Path) -> None:
    study = study_of(levels=8, keep=Keep.NEAR_BOUNDARY)
    told: list[Progress] = []
    run(tmp_path, study, tell=told.append, mischief="fails", when=(5,))
    assert told[-1].stage is Stage.WAVEFORMS
    assert told[-1].done == told[-1].total
    assert told[-1].failed == 1
    assert told[-1].left == 0.0
    done = [progress.done for progress in told if progress.stage is Stage.RUNS]
    assert done == sorted(done)
    again: list[Progress] = []
    run(tmp_path, study, tell=again.append)
    assert [progress.done for progress in again] == [128, told[-1].done]


@pytest.mark.thorough
def test_an_interrupted_exploration_keeps_what_is_finished_and_goes_on(tmp_path: Path) -> None:
    study = study_of(levels=12, keep=Keep.NEAR_BOUNDARY)

    def stop(progress: Progress) -> None:
        if progress.done > 20:
            raise KeyboardInterrupt

    with pytest.raises(ExplorationInterruptedError, match=r"stopped after \d+ of 288 runs.*same command") as caught:
        run(tmp_path, study, workers=2, tell=stop, seconds=0.005)
    assert multiprocessing.active_children() == []
    with StudyFolder.open(tmp_path) as folder:
        finished = folder.finished()
    assert 20 < len(finished) == caught.value.finished < 288
    summary = run(tmp_path, study, workers=2)
    assert summary.simulated == 288 - len(finished) + summary.kept
    run(tmp_path / "whole", study)
    assert content(tmp_path)[0] == content(tmp_path / "whole")[0]


KILLED = """
import sys
from pathlib import Path
sys.path[:0] = {paths!r}
from fake_runners import benches, definition_of, make_fake, study_of
from dse.domain.study import Keep
from dse.errors import DseError
from dse.exploration.executors.local import Local
from dse.exploration.loop import explore
from dse.storage.folder import StudyFolder

study = study_of(levels=12, keep=Keep({keep!r}))
with StudyFolder.resume(Path({folder!r}), definition_of(study, ("a", "b"))) as folder:
    explore(study, benches("a", "b", seconds=0.03), folder, executor=Local(workers=2), make_runner=make_fake)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="process groups")
@pytest.mark.parametrize("keep", [Keep.NONE, Keep.ALL])
@pytest.mark.thorough
def test_killed_at_once_with_all_its_workers_it_later_runs_only_what_is_missing(tmp_path: Path, keep: Keep) -> None:
    # The script has no main guard, and its process no importable main module: workers start all the same.
    here = Path(__file__).parent
    script = tmp_path / "script.py"
    paths = [str(here), str(here.parent), str(here.parents[1])]
    script.write_text(KILLED.format(paths=paths, keep=str(keep), folder=str(tmp_path / "study")), encoding="utf-8")
    # What a killed process leaves in the folder for temporary files stays with the test.
    process = subprocess.Popen(
        [sys.executable, str(script)], start_new_session=True, env={**os.environ, "TMPDIR": str(tmp_path)}
    )
    try:
        wait_for_runs(tmp_path / "study", 40)
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    with StudyFolder.open(tmp_path / "study") as folder:
        finished = folder.finished()
    assert 40 <= len(finished) < 288
    study = study_of(levels=12, keep=keep)
    summary = run(tmp_path / "study", study, workers=2)
    assert summary.before >= len(finished)  # with those that were spooled and not stored
    assert summary.simulated == 288 - summary.before
    assert summary.irreproducible == 0
    run(tmp_path / "whole", study)
    assert content(tmp_path / "study") == content(tmp_path / "whole")


def wait_for_runs(path: Path, least: int) -> None:
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline:
        if (path / "study.sqlite").exists():
            with StudyFolder.open(path) as folder:
                if len(folder.finished()) >= least:
                    return
        time.sleep(0.02)
    raise AssertionError("the exploration does not get on")


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.thorough
def test_ctrl_c_in_a_terminal_reaches_workers_too_and_loses_nothing(tmp_path: Path) -> None:
    here = Path(__file__).parent
    script = tmp_path / "script.py"
    paths = [str(here), str(here.parent), str(here.parents[1])]
    script.write_text(KILLED.format(paths=paths, keep="none", folder=str(tmp_path / "study")), encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, str(script)], start_new_session=True, stderr=subprocess.PIPE, encoding="utf-8"
    )
    wait_for_runs(tmp_path / "study", 40)
    os.killpg(process.pid, signal.SIGINT)
    _, error = process.communicate(timeout=120)
    assert error.count("Traceback") == 1
    assert "ExplorationInterruptedError: stopped after" in error
    assert run(tmp_path / "study", study_of(levels=12)).simulated < 288 - 40 + 1
