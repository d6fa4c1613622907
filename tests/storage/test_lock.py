"""One writer per study folder."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from dse.domain.definition import StudyDefinition
from dse.errors import DseError
from dse.storage.attempts import this_process
from dse.storage.folder import StudyFolder
from dse.storage.lock import Writer, WriterLock, writer_of

HOLDS = """
import sys
from pathlib import Path
from dse.storage.lock import WriterLock
with WriterLock(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def holder(stored: Path) -> Iterator[subprocess.Popen[str]]:
    """Another process that writes into the study."""
    command = [sys.executable, "-c", HOLDS, str(stored)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


def test_a_second_writer_is_told_who_the_first_is_and_readers_are_not_kept_away(
    stored: Path, definition: StudyDefinition, holder: subprocess.Popen[str]
) -> None:
    host, _, _ = this_process().rpartition("/")
    with pytest.raises(DseError, match=rf"process {holder.pid} on {host} is at work in it\n    hint: wait for it"):
        StudyFolder.resume(stored, definition)
    with pytest.raises(DseError, match="is at work in it"):
        StudyFolder.discard(stored)
    writer = writer_of(stored)
    assert writer is not None
    assert (writer.host, writer.process) == (host, holder.pid)
    with StudyFolder.open(stored) as folder:
        assert len(folder.table()) == 4
    assert writer_of(stored) == writer


def test_a_dead_process_holds_nothing(stored: Path, definition: StudyDefinition, holder: subprocess.Popen[str]) -> None:
    holder.kill()
    holder.wait()
    assert (stored / "writer.json").exists()
    assert writer_of(stored) is None
    StudyFolder.resume(stored, definition).close()
    assert sorted(entry.name for entry in stored.iterdir()) == ["study.sqlite", "waveforms"]


def test_a_folder_can_be_opened_once_for_writing(tmp_path: Path, definition: StudyDefinition) -> None:
    with StudyFolder.create(tmp_path, definition) as folder:
        assert str(writer_of(tmp_path)).startswith(f"process {os.getpid()} on ")
        with pytest.raises(DseError, match=f"process {os.getpid()} on"):
            StudyFolder.resume(tmp_path, definition)
        folder.commit()
    assert writer_of(tmp_path) is None
    StudyFolder.resume(tmp_path, definition).close()


def test_a_refused_study_lets_go(stored: Path, definition: StudyDefinition) -> None:
    with pytest.raises(DseError, match="another study"):
        StudyFolder.resume(stored, replace(definition, fmus={"pd_acc": "4567"}))
    StudyFolder.resume(stored, definition).close()


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"host": "a", "process": "x", "started": 1}',
        '{"host": "a", "process": Infinity, "started": 1}',
        "[" * 100_000,
        "\xff",
    ],
)
def test_a_note_that_says_nothing_names_nobody(tmp_path: Path, text: str) -> None:
    (tmp_path / "writer.json").write_text(text, encoding="latin-1")
    assert writer_of(tmp_path) is None


def test_another_process_of_the_same_number_is_not_the_writer(tmp_path: Path) -> None:
    host, _, process = this_process().rpartition("/")
    note = {"host": host, "process": int(process), "started": 1}
    (tmp_path / "writer.json").write_text(json.dumps(note), encoding="utf-8")
    assert writer_of(tmp_path) is None


def test_a_writer_that_was_killed_on_another_host_holds_nothing(tmp_path: Path) -> None:
    """As after a container was started again, under another name."""
    note = json.dumps({"host": "elsewhere", "process": 7, "started": 1})
    with WriterLock(tmp_path):
        (tmp_path / "writer.json").write_text(note, encoding="utf-8")
        assert writer_of(tmp_path) == Writer("elsewhere", 7, 1)
    (tmp_path / "writer.json").write_text(note, encoding="utf-8")
    for _ in range(2):
        assert writer_of(tmp_path) is None
        (tmp_path / "writer.lock").touch()


def test_without_locks_the_note_decides(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Some file systems of clusters have none."""

    def refuse(*_arguments: object, **_options: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr("filelock.FileLock.acquire", refuse)
    first = WriterLock(tmp_path)
    with pytest.raises(DseError, match="is at work in it"):
        WriterLock(tmp_path)
    first.release()
    (tmp_path / "writer.json").write_text('{"host": "elsewhere", "process": 7, "started": 1}', encoding="utf-8")
    with pytest.raises(DseError, match=r"process 7 on elsewhere is at work in it[\s\S]*delete writer\.json"):
        WriterLock(tmp_path)
