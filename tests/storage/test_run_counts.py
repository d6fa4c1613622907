"""How a study is getting on, as another process sees it."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

from dse.api.studies.status import status, statuses
from dse.cli.arguments import Output
from dse.cli.commands.status import status as command
from dse.domain.definition import StudyDefinition
from dse.domain.run import Outcome, Run, RunRequest
from dse.errors import DseError
from dse.storage.attempts import Attempt, this_process
from dse.storage.folder import StudyFolder
from dse.storage.rows import Measures
from dse.storage.write_ahead_log import LogWriter

Add = Callable[[StudyFolder, Run], None]


@pytest.fixture(autouse=True)
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("dse.api.studies.status._PATIENCE", 0.0)


def shown(folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    command(folder)
    return capsys.readouterr().out


def test_a_study_that_nobody_goes_on_with_is_interrupted(stored: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = status(stored)
    assert (found.state, found.runs, found.tally.finished, found.tally.failed) == ("interrupted", 6, 4, 1)
    assert (found.rate, found.left, found.working) == (0.0, math.inf, ())
    assert [(m.host + "/" + str(m.process), m.runs, m.tries, m.seconds) for m in found.tally.makers] == [
        (this_process(), 4, 0, 0.5)
    ]
    text = shown(stored, capsys)
    assert "gains, interrupted" in text
    assert "4 of 6 (66 %), 1 failed" in text
    assert 'world: "t" < 3 s\N{REPLACEMENT CHARACTER} & more' in text


def test_runs_in_the_spool_are_counted(stored: Path, definition: StudyDefinition, runs: list[Run]) -> None:
    with StudyFolder.open(stored) as folder:
        header, log_folder = folder.header, folder.log_folder
    measures = Measures(header.metrics, header.requirements)
    with LogWriter(log_folder, "runs-0", this_process(), measures, header.fingerprint) as writer:
        for number in (0, 3):
            request = RunRequest(number, "c1", {"controller.kp": 0.1})
            writer.add(Run(request, Outcome.DONE, runs[0].metrics, runs[0].judgements), 0.5)
    assert status(stored).logged == 1


def test_a_running_study_has_a_writer_a_rate_and_an_end(
    stored: Path, definition: StudyDefinition, capsys: pytest.CaptureFixture[str]
) -> None:
    with StudyFolder.resume(stored, definition):
        found = status(stored)
        text = shown(stored, capsys)
    assert found.writer is not None
    assert f"{found.writer.host}/{found.writer.process}" == this_process()
    assert (found.state, found.rate, found.left) == ("running", 2.0, 1.0)  # half a second a run, two to go
    assert "2 runs/s, about 0:00:01 left" in text


def test_the_rate_is_that_of_the_runs_that_came_meanwhile(
    stored: Path, definition: StudyDefinition, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = [10.0]
    with StudyFolder.resume(stored, definition) as folder:

        def wait(_: float) -> None:
            folder.add_attempts([Attempt(0, this_process(), "", 9.0)] * 20)
            folder.commit()
            clock[0] += 2.0

        monkeypatch.setattr("dse.api.studies.status.time.monotonic", lambda: clock[0])
        monkeypatch.setattr("dse.api.studies.status.time.sleep", wait)
        assert status(stored).rate == 10.0


def test_tries_without_a_result_are_told_by_their_cause(
    stored: Path, definition: StudyDefinition, capsys: pytest.CaptureFixture[str]
) -> None:
    tries = [
        Attempt(0, "far/7", "no answer for 2 s in head: fmi2DoStep at t = 0.5 s", 2.0),
        Attempt(1, "far/8", "no answer for 2 s in head: fmi2DoStep at t = 1e-05 s", 2.0),
        Attempt(1, "far/8", "crashed (signal 11)", 2.0),
        Attempt(2, this_process(), "", 0.5),
    ]
    with StudyFolder.resume(stored, definition) as folder:
        folder.add_attempts(tries)
    found = status(stored)
    assert (found.tally.repeated, found.tally.again) == (2, 1)
    text = shown(stored, capsys)
    assert "  2 × no answer for 2 s in head: fmi2DoStep\n  1 × crashed (signal 11)\n" in text
    command(stored, Output.JSON)
    data = json.loads(capsys.readouterr().out)
    assert data["without_result"]["runs"] == 2
    assert [worker["without_result"] for worker in data["workers"] if worker["host"] == "far"] == [1, 2]
    assert data["seconds_left"] == "inf"


def test_shards_are_told_side_by_side(
    tmp_path: Path, stored: Path, definition: StudyDefinition, capsys: pytest.CaptureFixture[str]
) -> None:
    together = tmp_path / "together"
    together.mkdir()
    stored.rename(together / "shard-1-of-2")
    with StudyFolder.create(together / "shard-2-of-2", definition):
        assert [each.state for each in statuses(together)] == ["at rest", "running"]
    assert "gains, 4 of 6 runs in 2 shards" in shown(together, capsys)


@pytest.mark.parametrize("content", [None, b"", b"SQLite format 3\0" + bytes(4000), b"no database" * 999])
def test_what_is_no_study_is_named(tmp_path: Path, content: bytes | None) -> None:
    if content is not None:
        (tmp_path / "study.sqlite").write_bytes(content)
    with pytest.raises(DseError, match=str(tmp_path)):
        command(tmp_path)
