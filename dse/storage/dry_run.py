"""What would become of a study folder, tried on a copy of its database."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Sequence
from contextlib import ExitStack, closing
from pathlib import Path

from dse.domain.definition import StudyDefinition
from dse.storage.database.connection import NAME, connect, fill, located, read_header
from dse.storage.database.header import StudyHeader
from dse.storage.folder import StudyFolder
from dse.storage.waveform_check import FileFacts


class DryRun(StudyFolder):
    """What `StudyFolder.resume` would give, as a copy that is gone when it is closed: the folder is left as it is.

    Runs that were logged and not stored are not in it.
    """

    @property
    def log_folder(self) -> Path:
        """Nothing is logged here."""
        return self.path / "nothing"

    def add_kept(self, numbers: Sequence[int], file: str) -> FileFacts | None:
        """Note that the waveforms of *numbers* would be in *file*."""
        return super().add_kept(numbers, file if (self.waveform_folder / file).is_file() else "")

    def _delete(self, files: Iterable[Path]) -> None:
        """Nothing is deleted."""

    @classmethod
    def of(cls, path: Path, definition: StudyDefinition) -> DryRun:
        """The folder at *path* as it would be taken up; a new one if there is none. DseError as from `resume`."""
        with ExitStack() as undo, located(path):
            copy = sqlite3.connect("", isolation_level=None)  # a file that SQLite removes
            undo.callback(copy.close)
            if (path / NAME).exists():
                with closing(connect(path, write=False)) as stored:
                    stored.backup(copy)
            else:
                fill(copy, StudyHeader(definition))
            header, asks = read_header(copy, path)
            folder = cls(path, header, copy, asks)
            folder.take_up(definition)
            folder.forget_damaged()
            undo.pop_all()
        return folder
