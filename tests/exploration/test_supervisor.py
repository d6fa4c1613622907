"""What goes wrong in a worker becomes the result of the run at hand, and of no other."""

from __future__ import annotations

import multiprocessing
import subprocess
import sys
from pathlib import Path
from typing import Any

import deadly_when_imported
import pytest
from fake_runners import METRICS, benches, definition_of, make_fake, study_of

from dse.domain.run import Outcome
from dse.domain.study import Keep, Study
from dse.errors import DseError
from dse.exploration.executors.local import Local
from dse.exploration.loop import Explored, explore
from dse.exploration.supervision import supervisor
from dse.storage.database.table import RunTable
from dse.storage.folder import StudyFolder

posix = pytest.mark.skipif(sys.platform == "win32", reason="signals")


def explored(path: Path, study: Study, *, workers: int = 1, **mischief: Any) -> tuple[Explored, RunTable, StudyFolder]:
    with StudyFolder.resume(path, definition_of(study)) as folder:
        summary = explore(
            study, benches("a", **mischief), folder, executor=Local(workers=workers), make_runner=make_fake
        )
        return summary, folder.table(), folder


def failures(table: RunTable) -> dict[int, str]:
    return {run.request.number: run.problem for run in table.runs() if run.outcome is Outcome.FAILED}


@pytest.mark.thorough
def test_a_worker_that_ends_itself_costs_the_run_at_hand_and_no_other(tmp_path: Path) -> None:
    summary, table, _ = explored(tmp_path, study_of(), mischief="exits", when=(7,))
    assert failures(table) == {7: "ended by itself (exit code 3) in fake: fmi2DoStep of run 7"}
    assert (summary.runs, summary.failed, summary.simulated) == (25, 1, 25)
    assert len(table) == 25


@posix
@pytest.mark.thorough
def test_a_crash_names_the_signal_and_the_place(tmp_path: Path) -> None:
    _, table, _ = explored(tmp_path, study_of(), mischief="crashes", when=(0, 24), workers=2)
    assert failures(table) == {n: f"crashed (signal 11) in fake: fmi2DoStep of run {n}" for n in (0, 24)}


@pytest.mark.thorough
def test_a_hanging_run_is_ended_after_its_timeout(tmp_path: Path) -> None:
    _, table, _ = explored(tmp_path, study_of(), mischief="hangs", when=(7,), timeout=2)
    assert failures(table) == {7: "no answer for 2 s in fake: fmi2DoStep of run 7"}


@pytest.mark.thorough
def test_a_run_that_only_takes_too_long_is_not_said_to_hang(tmp_path: Path) -> None:
    _, table, _ = explored(tmp_path, study_of(), mischief="takes long", when=(7,), timeout=2)
    assert failures(table) == {7: "took longer than its limit of 2 s in fake: fmi2DoStep of run 7"}


@pytest.mark.thorough
def test_slow_runs_are_not_hanging_runs(tmp_path: Path) -> None:
    # The batch as a whole takes longer than a run may.
    _, table, _ = explored(tmp_path, study_of(levels=5), seconds=0.1, timeout=2)
    assert failures(table) == {}


@posix
@pytest.mark.thorough
def test_a_run_whose_worker_was_killed_from_outside_is_tried_once_more(tmp_path: Path) -> None:
    summary, table, _ = explored(
        tmp_path / "study", study_of(), mischief="is killed", when=(7,), file=tmp_path / "happened"
    )
    assert failures(table) == {}
    assert summary.retried == 1


@posix
@pytest.mark.thorough
def test_a_run_that_gets_its_worker_killed_again_is_recorded(tmp_path: Path) -> None:
    summary, table, _ = explored(tmp_path, study_of(), mischief="is killed", when=(7,))
    assert failures(table) == {7: "killed from outside (signal 9) in fake: fmi2DoStep of run 7"}
    assert summary.retried == 1


@pytest.mark.thorough
def test_an_unexpected_exception_is_a_failed_run(tmp_path: Path) -> None:
    _, table, _ = explored(tmp_path, study_of(), mischief="raises", when=(3, 4))
    assert set(failures(table)) == {3, 4}
    assert failures(table)[3].startswith("unexpected ValueError at fake_runners.py:")
    assert failures(table)[3].endswith(": bad run 3")


@pytest.mark.thorough
def test_a_run_that_lacks_a_metric_is_a_failed_run(tmp_path: Path) -> None:
    _, table, _ = explored(tmp_path, study_of(), mischief="forgets", when=(3,))
    assert set(failures(table)) == {3}
    assert failures(table)[3].endswith("the simulation gave no m3")


def test_a_failure_the_executor_reports_is_stored_in_its_words(tmp_path: Path) -> None:
    _, table, _ = explored(tmp_path, study_of(), mischief="fails", when=(3,))
    assert failures(table) == {3: "world: fmi2DoStep at t = 3.21 s returned error"}


@pytest.mark.skipif(sys.platform != "linux", reason="RLIMIT_AS")
@pytest.mark.thorough
def test_a_run_that_wants_too_much_memory_fails_alone(tmp_path: Path) -> None:
    _, table, _ = explored(tmp_path, study_of(), mischief="eats memory", when=(3,))
    assert set(failures(table)) == {3}
    assert "MemoryError" in failures(table)[3]


def test_a_configuration_that_cannot_be_loaded_fails_in_each_of_its_runs(tmp_path: Path) -> None:
    study = study_of(levels=2)
    with StudyFolder.create(tmp_path, definition_of(study, ("a", "b"))) as folder:
        prepared = {**benches("a", mischief="refuses"), **benches("b")}
        explore(study, prepared, folder, executor=Local(workers=1), make_runner=make_fake)
        problems = failures(folder.table())
    assert set(problems) == {0, 1, 2, 3}
    assert problems[0].startswith("sensor.gap -> controller.speed: units differ")


@pytest.mark.thorough
def test_workers_that_die_before_any_run_end_the_exploration(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    study = study_of()
    with (
        StudyFolder.create(tmp_path, definition_of(study)) as folder,
        pytest.raises(
            DseError,
            match=r"5 workers in a row ended outside of any run, the last while starting.*code 7[\s\S]*a library is",
        ),
    ):
        explore(study, benches("a"), folder, executor=Local(workers=2), make_runner=deadly_when_imported.make)
    with StudyFolder.open(tmp_path) as folder:
        assert folder.finished() == set()
    assert multiprocessing.active_children() == []
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.thorough
def test_a_configuration_that_kills_workers_while_it_is_loaded_fails_alone(workers: int, tmp_path: Path) -> None:
    study = study_of(levels=5)
    with StudyFolder.create(tmp_path, definition_of(study, ("a", "b", "c"))) as folder:
        prepared = {
            **benches("a", mischief="dies loading"),
            **benches("b"),
            **benches("c", mischief="dies loading"),
        }
        explore(study, prepared, folder, executor=Local(workers=workers), make_runner=make_fake)
        problems = failures(folder.table())
        assert folder.finished() == set(range(75))
    assert set(problems) == {*range(25), *range(50, 75)}
    assert set(problems.values()) == {
        "ended by itself (exit code 7) while its FMUs were loaded; printed last: cannot open libfake.so"
    }


@pytest.mark.thorough
def test_what_a_run_printed_before_it_ended_its_worker_is_told(tmp_path: Path) -> None:
    _, table, _ = explored(tmp_path, study_of(), mischief="prints and exits", when=(3, 4))
    # What another run of the same worker has printed is not told.
    assert failures(table) == {
        n: f"ended by itself (exit code 3) in fake: fmi2DoStep of run {n}; printed last: oil is low in run {n}"
        for n in (3, 4)
    }


def test_a_worker_that_hangs_while_loading_is_not_waited_for_forever(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(supervisor, "START_TIMEOUT", 0.01)
    with pytest.raises(DseError, match=r"no answer for 0\.01 s"):
        explored(tmp_path, study_of())


def test_waveforms_that_cannot_be_written_end_the_exploration_but_not_the_results(tmp_path: Path) -> None:
    study = study_of(keep=Keep.ALL)
    StudyFolder.create(tmp_path, definition_of(study)).close()
    # A folder where the first chunk's file is to be: the rename over it fails on every system.
    (tmp_path / "waveforms" / "runs-00000000-00000000.parquet").mkdir()
    with pytest.raises(DseError, match="waveforms cannot be written"):
        explored(tmp_path, study)
    assert multiprocessing.active_children() == []


@pytest.mark.thorough
@posix
def test_waveforms_of_a_chunk_survive_a_crash_in_it(tmp_path: Path) -> None:
    # 2,500 runs make chunks of 32, so that run 40 crashes in the middle of one.
    study = study_of(levels=50, keep=Keep.ALL)
    with StudyFolder.create(tmp_path, definition_of(study)) as folder:
        prepared = benches("a", mischief="crashes", when=(40,))
        summary = explore(study, prepared, folder, executor=Local(workers=2), make_runner=make_fake)
        assert (summary.failed, summary.kept, summary.irreproducible) == (1, 2499, 0)
        assert set(folder.kept()) == set(range(2500)) - {40}
        for number in (32, 39, 41, 63, 2499):
            waveforms = folder.waveforms(number)
            assert waveforms is not None
            assert waveforms.values["world.gap"].tolist() == [float(number)] * 11


@pytest.mark.thorough
def test_metrics_arrive_as_they_were_computed(tmp_path: Path) -> None:
    _, table, _ = explored(tmp_path, study_of(), workers=2)
    total = sum(table.points.values())
    for i, name in enumerate(METRICS[:6]):
        assert (table.metric(name) == total * (i + 1)).all()


@pytest.mark.thorough
def test_no_worker_is_left_behind(tmp_path: Path) -> None:
    explored(tmp_path, study_of(), workers=2)
    assert multiprocessing.active_children() == []


def test_a_worker_starts_without_the_heavy_libraries() -> None:
    heavy = "pandas, matplotlib, scipy, pint, pyarrow, fmpy, typer, ruamel"
    look = f"import sys, dse.exploration.supervision.worker; print({{*{heavy.split(', ')!r}}} & {{*sys.modules}})"
    root = Path(__file__).parents[2]
    shown = subprocess.run([sys.executable, "-c", look], cwd=root, check=True, capture_output=True, encoding="utf-8")
    assert shown.stdout.strip() == "set()"
