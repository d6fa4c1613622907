"""A study folder as its readers see it: `study.sqlite` with a row per run, and the waveforms that were kept."""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from dse.domain.address import Address
from dse.domain.definition import StudyDefinition
from dse.domain.provenance import Provenance
from dse.domain.run import Run, Waveforms
from dse.errors import Location, fail
from dse.storage.attempts import Attempt
from dse.storage.database.addresses import read_addresses
from dse.storage.database.attempts import read_attempts, read_causes, read_retried
from dse.storage.database.connection import connect, damaged_study, located, read_header, require_structure
from dse.storage.database.definition import unit_flaws
from dse.storage.database.files import read_files
from dse.storage.database.header import StudyHeader
from dse.storage.database.provenance import read_provenance
from dse.storage.database.row_checksum import row_checksums
from dse.storage.database.run_counts import RunCounts, read_run_counts
from dse.storage.database.sampler_requests import SamplerRequests
from dse.storage.database.table import RunTable, read_table, read_verdicts
from dse.storage.waveform_check import FileFacts, size_of
from dse.storage.waveforms import is_file_name, read_waveforms
from dse.storage.write_ahead_log import read_log

WAVEFORMS = "waveforms"
SPOOL = "spool"


class StudyReader:
    """One study's results. Close it, or use it in a with statement; others may read and one may write meanwhile."""

    def __init__(self, path: Path, header: StudyHeader, connection: sqlite3.Connection, asks: SamplerRequests) -> None:
        self.path = path
        self.header = header
        self.asks = asks
        self._connection = connection
        self._is_sound = False

    @classmethod
    def open(cls, path: Path) -> Self:
        """The folder at *path* for reading; DseError if it is none, is damaged or was written by a newer dse."""
        return cls._connected(path, write=False)

    @classmethod
    def snapshot(cls, path: Path) -> Self:
        """As `open`; all that is read until it is closed is of one moment, whatever is written meanwhile."""
        return cls._connected(path, write=False, stays=True)

    @property
    def waveform_folder(self) -> Path:
        """Where the waveform files lie."""
        return self.path / WAVEFORMS

    @property
    def log_folder(self) -> Path:
        """What those who make the runs need aside: what is not in the database yet, and nothing after a study's end."""
        return self.path / SPOOL

    def finished(self) -> set[int]:
        """Numbers of the runs that have a row, done or failed."""
        return self._numbers("SELECT number FROM runs")

    def count(self) -> int:
        """How many runs have a row."""
        with located(self.path):
            return int(self._connection.execute("SELECT count(*) FROM runs").fetchone()[0])

    def failed(self) -> set[int]:
        """Numbers of the runs that failed."""
        return self._numbers("SELECT number FROM runs WHERE outcome = 'failed'")

    def with_problem(self, start: str) -> set[int]:
        """Numbers of the runs whose problem has this *start*, without wildcards."""
        return self._numbers(f"SELECT number FROM runs WHERE problem GLOB '{start}*'")  # noqa: S608  # a constant

    def kept(self) -> Mapping[int, str]:
        """Waveform file by number for the runs whose waveforms were asked for; "" where there are none to store."""
        with located(self.path):
            rows = self._connection.execute("SELECT * FROM kept ORDER BY number").fetchall()
        return self._checked(rows)

    def lost(self) -> set[int]:
        """Numbers of the runs whose waveforms were kept in a file that is gone or has another size."""
        kept, known = self.kept(), self.files()
        sizes = {file: size_of(self.waveform_folder / file) for file in {*kept.values()} - {""}}
        gone = {file for file, size in sizes.items() if size != (known[file].size if file in known else size or 0)}
        return {number for number, file in kept.items() if file in gone}

    def require_definition(self) -> StudyDefinition:
        """The study's definition, fit to be shown; DseError if it has units that nobody can read."""
        flaw = next(unit_flaws(self.header.definition), "")
        if flaw:
            raise damaged_study(self.path, flaw)
        return self.header.definition

    def table(self, numbers: Sequence[int] = ()) -> RunTable:
        """The runs of *numbers* that are stored, or all that are, as columns; DseError if the database is damaged."""
        if not numbers:
            self.require_structure()
        try:
            with located(self.path):
                return read_table(self._connection, self.header, numbers)
        except (KeyError, ValueError, TypeError) as error:
            raise damaged_study(self.path, str(error)) from error

    def require_structure(self) -> None:
        """DseError if a page of the database is damaged; looked at once."""
        if not self._is_sound:
            require_structure(self._connection, self.path)
            self._is_sound = True

    def run(self, number: int) -> Run:
        """Run *number* with its waveforms if they were kept; DseError if it has not been made."""
        for run in self.table((number,)).runs():
            return replace(run, waveforms=self.waveforms(number))
        raise fail(
            f"there is no run {number}", Location(str(self.path)), f"the study has runs 0 to {self.header.numbers - 1}"
        )

    def waveforms(self, number: int) -> Waveforms | None:
        """The waveforms of run *number*, None if they were not kept; DseError if their file is gone or damaged."""
        with located(self.path):
            rows = self._connection.execute("SELECT * FROM kept WHERE number = ?", (number,)).fetchall()
        file = self._checked(rows).get(number)
        return read_waveforms(self.waveform_folder / file, number) if file else None

    def addresses(self) -> dict[str, Address]:
        """What names the runs of each configuration, as far as it is known."""
        with located(self.path):
            return read_addresses(self._connection)

    def attempts(self) -> list[Attempt]:
        """Every try at a run, in the order they were made."""
        with located(self.path):
            return read_attempts(self._connection)

    def retried(self) -> dict[str, list[int]]:
        """What tries came to that were made again, each with its runs."""
        with located(self.path):
            return read_retried(self._connection)

    def notes(self) -> Provenance | None:
        """What is kept besides the results, None if nothing is, as of a study that an earlier version made."""
        try:
            with located(self.path):
                return read_provenance(self._connection)
        except ValueError as error:
            raise damaged_study(self.path, str(error)) from error

    def causes(self) -> dict[int, str]:
        """What the last try came to that gave no row, by run; not that it was stopped with its program."""
        with located(self.path):
            return read_causes(self._connection)

    def logged(self) -> set[int]:
        """Numbers of the runs that are made and lie in the write-ahead log only."""
        found = read_log(self.log_folder, self.header.measures, self.header.fingerprint)
        return {number for each in found for number in each.block.numbers.tolist()} - self.finished()

    def tally(self) -> RunCounts:
        """How far it is, and who made its runs."""
        with located(self.path):
            return read_run_counts(self._connection)

    def verdicts(self) -> Mapping[tuple[str, ...], int]:
        """How many runs came to each combination of verdicts on the requirements, in the header's order."""
        with located(self.path):
            return read_verdicts(self._connection, self.header.requirements)

    def close(self) -> None:
        """Close it."""
        self._connection.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @classmethod
    def _connected(cls, path: Path, *, write: bool, stays: bool = False) -> Self:
        connection = connect(path, write=write)
        try:
            with located(path):
                connection.execute("BEGIN")  # what is read here is of one moment, whatever is written meanwhile
                header, asks = read_header(connection, path)
                if not stays:
                    connection.execute("COMMIT")
        except BaseException:
            connection.close()
            raise
        return cls(path, header, connection, asks)

    def files(self) -> dict[str, FileFacts]:
        """What is known of the files of waveforms, by name."""
        with located(self.path):
            return read_files(self._connection)

    def _checked(self, rows: Sequence[tuple[Any, ...]]) -> dict[int, str]:
        """Files by number of rows (number, file, and a row checksum if the database has such)."""
        files = [row[1] or "" for row in rows]
        # The database may come from anywhere: what it names must lie in the folder of waveforms.
        for file in {*files} - {""}:
            if not (isinstance(file, str) and is_file_name(file)):
                raise damaged_study(self.path, f"'{file}' is not a file of waveforms")
        numbers = [row[0] for row in rows]
        wanted = row_checksums([numbers, files]).tolist() if rows else []
        for row, checksum in zip(rows, wanted, strict=True):
            if row[2:] and row[2] not in (None, checksum):
                raise damaged_study(self.path, f"where the waveforms of run {row[0]} are is not what was written")
        return dict(zip(numbers, files, strict=True))

    def _numbers(self, query: str) -> set[int]:
        with located(self.path):
            return {number for (number,) in self._connection.execute(query)}
