"""What cannot be written is told by its cause, and nothing of it is left."""

from __future__ import annotations

import errno
import sqlite3
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dse.domain.definition import StudyDefinition
from dse.domain.run import Run
from dse.errors import DseError
from dse.storage.attempts import Attempt
from dse.storage.folder import StudyFolder
from dse.storage.write_ahead_log import LogWriter

Add = Callable[[StudyFolder, Run], None]


class Refusing:
    """A connection that refuses what begins with *words*."""

    def __init__(self, connection: sqlite3.Connection, words: str, code: int) -> None:
        self._connection, self._words, self._code = connection, words, code

    def __getattr__(self, name: str) -> Any:
        return getattr(self._connection, name)

    def executemany(self, statement: str, rows: Any) -> Any:
        return self._refuse(statement) or self._connection.executemany(statement, rows)

    def execute(self, statement: str, *values: Any) -> Any:
        return self._refuse(statement) or self._connection.execute(statement, *values)

    def _refuse(self, statement: str) -> None:
        if statement.startswith(self._words):
            error = sqlite3.OperationalError("as the test says")
            error.sqlite_errorcode = self._code
            raise error


def test_a_database_that_cannot_grow_says_that_the_disk_is_full_and_loses_nothing(
    stored: Path, definition: StudyDefinition, runs: list[Run], add: Add
) -> None:
    with StudyFolder.resume(stored, definition) as folder:
        before = folder.attempts()
        (pages,) = folder._connection.execute("PRAGMA page_count").fetchone()
        folder._connection.execute(f"PRAGMA max_page_count = {pages}")
        again = replace(runs[0], request=replace(runs[0].request, number=3), problem="x" * 20_000)
        with pytest.raises(DseError, match=r"the disk is full[\s\S]*what was finished is stored.*same command resumes"):
            add(folder, again)
        folder.commit()
    with StudyFolder.resume(stored, definition) as folder:
        assert folder.finished() == {0, 1, 2, 4}
        assert folder.attempts() == before
        add(folder, again)
    with StudyFolder.open(stored) as folder:
        assert folder.run(3).problem == "x" * 20_000


@pytest.mark.parametrize("words", ["BEGIN", "INSERT OR IGNORE INTO runs", "INSERT INTO attempts", "COMMIT"])
def test_a_write_that_fails_leaves_nothing_of_it_and_what_was_spooled_stays(
    stored: Path, definition: StudyDefinition, runs: list[Run], add: Add, words: str
) -> None:
    def store(folder: StudyFolder) -> None:
        add(folder, replace(runs[3], request=replace(runs[3].request, number=5)))
        folder.release("runs-00000005")
        folder.commit()

    with pytest.raises(DseError, match="the disk is full"), StudyFolder.resume(stored, definition) as folder:  # noqa: PT012
        with LogWriter(folder.log_folder, "runs-00000005", "a/1", folder.header.measures) as writer:
            writer.add(runs[0], 0.0)
        before = folder.attempts()
        folder._connection = Refusing(folder._connection, words, sqlite3.SQLITE_FULL)  # type: ignore[assignment]
        try:
            store(folder)
        finally:
            assert not folder._connection.in_transaction
            assert len([*folder.log_folder.iterdir()]) == 1
    with StudyFolder.open(stored) as folder:
        assert (folder.finished(), folder.attempts()) == ({0, 1, 2, 4}, before)


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (sqlite3.SQLITE_FULL, "the disk is full"),
        (sqlite3.SQLITE_IOERR_WRITE, "the system refused"),
        (sqlite3.SQLITE_READONLY_DIRECTORY, "it may not be written to"),
        (sqlite3.SQLITE_BUSY_SNAPSHOT, "another program keeps it locked"),
        (sqlite3.SQLITE_CANTOPEN, "a file could not be opened"),
        (sqlite3.SQLITE_CORRUPT_INDEX, "is damaged"),
        (sqlite3.SQLITE_CORRUPT, "cannot be used, the disk did not give all of it"),  # what SQLite makes of EIO
        (sqlite3.SQLITE_ERROR, "is damaged"),
    ],
)
def test_causes_are_told_by_name(stored: Path, definition: StudyDefinition, code: int, words: str) -> None:
    with StudyFolder.resume(stored, definition) as folder:
        folder._connection = Refusing(folder._connection, "INSERT", code)  # type: ignore[assignment]
        with pytest.raises(DseError, match=rf"study\.sqlite.* {words}"):
            folder.add_attempts([Attempt(0, "", "", 0.0)])


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (errno.ENOSPC, "the disk is full"),
        (errno.EDQUOT, "the disk quota is used up"),
        (errno.EROFS, "the file system is read-only"),
        (errno.EACCES, "there is no right to"),
        (errno.ELOOP, "as the test says"),
    ],
)
@pytest.mark.parametrize("where", ["pathlib.Path.mkdir", "pathlib.Path.write_text", "pathlib.Path.replace"])
def test_a_folder_that_cannot_be_written_to_is_told_by_its_cause(
    tmp_path: Path, definition: StudyDefinition, monkeypatch: pytest.MonkeyPatch, where: str, number: int, words: str
) -> None:
    def refuse(*_arguments: object, **_options: object) -> None:
        raise OSError(number, "as the test says")

    with monkeypatch.context() as patch:
        patch.setattr(where, refuse)
        with pytest.raises(DseError, match=rf"the folder cannot be (written to|made): {words}"):
            StudyFolder.resume(tmp_path / "study", definition)
    StudyFolder.resume(tmp_path / "study", definition).close()
