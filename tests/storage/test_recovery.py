"""Going on with a study whose program was killed: what is in the write-ahead log counts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dse.domain.bench import Judgement, Verdict
from dse.domain.definition import StudyDefinition
from dse.domain.run import Outcome, Run, RunRequest, Waveforms
from dse.errors import DseError
from dse.storage.attempts import Attempt
from dse.storage.database.definition import fingerprint
from dse.storage.export.tables import EXPORTS
from dse.storage.folder import StudyFolder
from dse.storage.merge import merge_studies
from dse.storage.rows import Measures
from dse.storage.waveforms import waveform_file, write_waveforms
from dse.storage.write_ahead_log import LogWriter, assemble, read_log

CHUNK = waveform_file(3, 5)
MAKER = "elsewhere/7"
MEASURES = Measures(("overshoot", "rise_time"), ("R1", "R2"))
WAVES = Waveforms(np.array([0.0, 1.0]), {"world.gap": np.array([2.0, 3.0])})

LogRuns = Callable[..., list[Path]]


def made(number: int, *, keep: bool = False, configuration: str = "c2", x: Any = 0.25, overshoot: float = 0.5) -> Run:
    judgements = (Judgement("R1", Verdict.PASS, 0.5), Judgement("R2", Verdict.FAIL, -0.5))
    request = RunRequest(number, configuration, {"controller.kp": x})
    metrics = {"overshoot": overshoot, "rise_time": 1.0}
    return Run(request, Outcome.DONE, metrics, judgements, waveforms=WAVES if keep else None)


@pytest.fixture
def log_runs(stored: Path, definition: StudyDefinition) -> LogRuns:
    """Spools runs and gives the files that are there then."""

    def log_runs(*runs: Run, name: str = CHUNK, study: str = fingerprint(definition), maker: str = MAKER) -> list[Path]:
        with LogWriter(stored / "spool", name, maker, MEASURES, study) as writer:
            for run in runs:
                writer.add(run, run.request.number / 16)
        return [*(stored / "spool").iterdir()]

    return log_runs


def resumed(stored: Path, definition: StudyDefinition) -> tuple[set[int], list[Attempt], list[Path]]:
    """Finished runs, attempts and write-ahead log files after going on."""
    with StudyFolder.resume(stored, definition) as folder:
        return folder.finished(), folder.attempts(), [*folder.log_folder.iterdir()]


def test_what_a_killed_shard_had_finished_is_merged(
    stored: Path, definition: StudyDefinition, log_runs: LogRuns, tmp_path: Path
) -> None:
    log_runs(made(3), made(5, keep=True))
    for _ in range(2):  # it can be done again
        merged = merge_studies(tmp_path / "whole", [stored])
        assert merged.finished == merged.of[stored] == 6
    with StudyFolder.open(tmp_path / "whole") as folder:
        assert folder.finished() == {0, 1, 2, 3, 4, 5}
        assert folder.run(3).metrics == {"overshoot": 0.5, "rise_time": 1.0}
        assert len(folder.attempts()) == len({*folder.attempts()})


def test_spooled_runs_become_rows_and_their_file_goes(
    stored: Path, definition: StudyDefinition, log_runs: LogRuns
) -> None:
    failed = replace(made(5), outcome=Outcome.FAILED, metrics={}, judgements=(), problem="world: hit")
    log_runs(made(3), failed, name="runs-00000003")
    with StudyFolder.open(stored) as folder:
        before = folder.attempts()
    finished, attempts, files = resumed(stored, definition)
    assert finished == {0, 1, 2, 3, 4, 5}
    assert attempts == [*before, Attempt(3, MAKER, "", 3 / 16), Attempt(5, MAKER, "", 5 / 16)]
    assert files == []
    with StudyFolder.open(stored) as folder:
        assert folder.run(3).metrics == {"overshoot": 0.5, "rise_time": 1.0}
        assert folder.run(3).request.point == {"controller.kp": 0.25}
        assert (folder.run(5).outcome, folder.run(5).problem) == (Outcome.FAILED, "world: hit")


def test_spooled_waveforms_stay_until_their_chunk_is_there(
    stored: Path, definition: StudyDefinition, log_runs: LogRuns
) -> None:
    files = log_runs(made(3, keep=True), made(5))
    first = resumed(stored, definition)
    assert first[0] == {0, 1, 2, 3, 4, 5}
    assert first[2] == files
    assert resumed(stored, definition) == first
    with StudyFolder.resume(stored, definition) as folder:
        logged = read_log(folder.log_folder, MEASURES, folder.header.fingerprint, CHUNK)
        assert assemble(folder.waveform_folder / CHUNK, logged, range(3, 6)) == (3,)
        folder.add_kept((3,), CHUNK)
    assert resumed(stored, definition)[2] == []


def test_a_run_that_was_stored_before_is_no_second_attempt_unless_it_was_one(
    stored: Path, definition: StudyDefinition, log_runs: LogRuns, runs: list[Run]
) -> None:
    with StudyFolder.resume(stored, definition) as folder:
        before = [*folder.attempts(), Attempt(0, MAKER, "", 0.0)]
        folder.add_attempts(before[-1:])
    again = replace(runs[1], waveforms=WAVES)
    files = log_runs(replace(runs[0], waveforms=WAVES), again, name=waveform_file(0, 2))
    assert resumed(stored, definition) == ({0, 1, 2, 4}, [*before, Attempt(1, MAKER, "", 1 / 16)], files)


def test_another_result_than_is_stored_is_left_to_be_found_again(
    stored: Path, definition: StudyDefinition, log_runs: LogRuns, runs: list[Run]
) -> None:
    with StudyFolder.open(stored) as folder:
        before = EXPORTS["csv"](folder)
    log_runs(replace(runs[0], metrics={"overshoot": 7.0, "rise_time": 7.0}, waveforms=WAVES), name=waveform_file(0, 2))
    assert resumed(stored, definition)[2] == []
    with StudyFolder.open(stored) as folder:
        assert EXPORTS["csv"](folder) == before


@pytest.mark.parametrize(
    ("run", "options"),
    [
        (made(3), {"study": "0123"}),
        (made(6), {}),
        (made(3, configuration="c1"), {}),
        (made(3, configuration="c9"), {}),
        (made(3, x="eco"), {}),
        (made(3, x=float("nan")), {}),
        (replace(made(3), request=RunRequest(3, "c2", {"other": 1.0})), {}),
    ],
    ids=["study", "number", "configuration", "unknown configuration", "text", "nan", "variable"],
)
def test_what_another_study_spooled_does_not_come_in(
    stored: Path, definition: StudyDefinition, log_runs: LogRuns, run: Run, options: dict[str, str]
) -> None:
    log_runs(run, **options)
    finished, _, files = resumed(stored, definition)
    assert (finished, files) == ({0, 1, 2, 4}, [])


def test_a_folder_that_is_refused_keeps_its_log(stored: Path, definition: StudyDefinition, log_runs: LogRuns) -> None:
    files = log_runs(made(3))
    with pytest.raises(DseError, match="another study"):
        StudyFolder.resume(stored, replace(definition, fmus={"pd_acc": "4567"}))
    assert [*(stored / "spool").iterdir()] == files
    assert resumed(stored, definition)[0] == {0, 1, 2, 3, 4}


def test_spooled_runs_of_a_study_that_is_extended_count_as_earlier_ones(
    stored: Path, definition: StudyDefinition, log_runs: LogRuns
) -> None:
    log_runs(made(3))
    wider = replace(definition, variables=(replace(definition.variables[0], high=2.0, levels=5),))
    with StudyFolder.resume(stored, wider) as folder:
        assert folder.finished() == {0, 1, 2, 3, 4}
        assert (folder.header.earlier, folder.header.runs) == (5, 5)


def test_forgotten_runs_are_to_be_made_again_and_their_attempts_stay(
    stored: Path, definition: StudyDefinition, log_runs: LogRuns
) -> None:
    log_runs(made(3, keep=True), made(5, keep=True))
    with StudyFolder.resume(stored, definition) as folder:
        write_waveforms(folder.waveform_folder / CHUNK, [(4, WAVES)])
        folder.add_kept((4,), CHUNK)
        before = folder.attempts()
        folder.forget({2, 3, 4, 77})
        assert folder.finished() == {0, 1, 5}
        assert folder.failed() == set()
        assert folder.kept() == {}
        assert folder.attempts() == before
        assert [*folder.log_folder.iterdir()] == []
    assert resumed(stored, definition)[0] == {0, 1, 5}


def test_forgetting_runs_of_an_earlier_era_is_counted(stored: Path, definition: StudyDefinition) -> None:
    wider = replace(definition, variables=(replace(definition.variables[0], high=2.0, levels=5),))
    with StudyFolder.resume(stored, wider) as folder:
        folder.forget({2})
        assert (folder.header.earlier, folder.header.runs) == (3, 3)
    with StudyFolder.open(stored) as folder:
        assert (folder.header.earlier, folder.header.runs) == (3, 3)
