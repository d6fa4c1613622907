"""The study folder: `study.sqlite` with a row per run, and `waveforms/` with the waveforms that were kept."""

from __future__ import annotations

import math
import shutil
import sqlite3
import time
from collections.abc import Mapping, Sequence, Set as AbstractSet
from contextlib import ExitStack
from dataclasses import replace
from itertools import groupby, repeat
from pathlib import Path
from types import TracebackType

import numpy as np

from dse.domain.bench import VERDICTS
from dse.domain.component import Value
from dse.domain.definition import StudyDefinition
from dse.domain.run import Outcome, Run, RunRequest, Waveforms
from dse.errors import Location, fail
from dse.storage.attempts import Attempt
from dse.storage.database.asks import Asks, blocks_of, write_asks
from dse.storage.database.attempts import read_attempts, write_attempts
from dse.storage.database.connection import (
    NAME,
    connect,
    damaged_study,
    lay_out,
    located,
    migrate,
    read_header,
    write_header,
)
from dse.storage.database.definition import unit_flaws
from dse.storage.database.header import StudyHeader
from dse.storage.database.schema import cell_of, columns
from dse.storage.database.table import RunTable, read_table
from dse.storage.lock import LOCK, WRITER, WriterLock
from dse.storage.rows import RowBlock
from dse.storage.spool import SUFFIX as SPOOLED, Spooled, clear_spool, read_spool
from dse.storage.waveforms import PART, is_file_name, read_waveforms

WAVEFORMS = "waveforms"
SPOOL = "spool"

_COMMIT_EVERY = 0.25
_OURS = (WAVEFORMS, SPOOL, LOCK, WRITER, "report.html", "figures")
"""What an earlier study may have left in a folder that is used again."""


class StudyFolder:
    """One study's results. Use `create`, `resume` or `open`; close it, or use it in a with statement.

    *is_extended* tells that `resume` was given a definition that asks for other runs.
    There is one writer; any number of readers may look on while it writes. What is added is committed every
    quarter of a second and at the end, so a killed process loses no more than that.
    """

    def __init__(
        self, path: Path, header: StudyHeader, connection: sqlite3.Connection, asks: Asks, lock: WriterLock | None
    ) -> None:
        self.path = path
        self.header = header
        self.asks = asks
        self._connection = connection
        self.is_extended = False
        self._begun: float | None = None
        self._released: set[str] = set()
        self._lock = lock

    @classmethod
    def create(cls, path: Path, definition: StudyDefinition) -> StudyFolder:
        """A new folder for the study of *definition*; DseError if *path* is a file or holds something else already."""
        if (path / NAME).exists():
            raise fail("holds a study already", Location(str(path)), "give another folder with -o, or say --fresh")
        return cls.resume(path, definition)

    @classmethod
    def resume(cls, path: Path, definition: StudyDefinition) -> StudyFolder:
        """The folder at *path* to go on with, or a new one; DseError if it holds the results of another study.

        If *definition* only asks for other points or more configurations than the stored one, the study is extended:
        a new era begins. Runs that were spooled and not stored are. Waveforms whose file is gone count as never kept,
        so that they are made again. DseError if somebody else writes into the folder.
        """
        _require_room(path)
        with ExitStack() as undo:
            lock = undo.enter_context(WriterLock(path))
            (path / WAVEFORMS).mkdir(exist_ok=True)
            if not (path / NAME).exists():
                lay_out(path, StudyHeader(definition))
            folder = undo.enter_context(cls._connected(path, lock))
            folder.take_up(definition)
            for torn in (path / WAVEFORMS).glob(f"*{PART}"):
                torn.unlink(missing_ok=True)
            folder.forget_lost()
            undo.pop_all()
        return folder

    @classmethod
    def open(cls, path: Path) -> StudyFolder:
        """The folder at *path* for reading; DseError if it is none, is damaged or was written by a newer dse."""
        return cls._connected(path, None)

    @staticmethod
    def discard(path: Path) -> None:
        """Remove the study in *path* and nothing else; DseError if there is something there that is no study."""
        if not (path / NAME).exists():
            if path.exists() and not (path.is_dir() and all(_is_ours(entry.name) for entry in path.iterdir())):
                raise fail("is not a study folder", Location(str(path)), "give another folder with -o")
            return
        with WriterLock(path):
            for pattern in (f"{NAME}*", f"{WAVEFORMS}/*.parquet", f"{WAVEFORMS}/*{PART}"):
                for file in path.glob(pattern):
                    file.unlink()
            shutil.rmtree(path / SPOOL, ignore_errors=True)

    @property
    def waveform_folder(self) -> Path:
        """Where the waveform files lie."""
        return self.path / WAVEFORMS

    @property
    def spool_folder(self) -> Path:
        """What those who make the runs need aside: what is not in the database yet, and nothing after a study's end."""
        return self.path / SPOOL

    def finished(self) -> set[int]:
        """Numbers of the runs that have a row, done or failed."""
        return self._numbers("SELECT number FROM runs")

    def failed(self) -> set[int]:
        """Numbers of the runs that failed."""
        return self._numbers("SELECT number FROM runs WHERE outcome = 'failed'")

    def kept(self) -> Mapping[int, str]:
        """Waveform file by number for the runs whose waveforms were asked for; "" where there are none to store."""
        with located(self.path):
            rows = self._connection.execute("SELECT number, file FROM kept ORDER BY number").fetchall()
        return {number: self._checked(file) for number, file in rows}

    def lost(self) -> set[int]:
        """Numbers of the runs whose waveforms were kept in a file that is there no more."""
        kept = self.kept()
        gone = {file for file in set(kept.values()) if file and not (self.waveform_folder / file).is_file()}
        return {number for number, file in kept.items() if file in gone}

    def forget_lost(self) -> None:
        """Take waveforms whose file is gone as never kept."""
        lost = self.lost()
        if lost:
            with located(self.path):
                self._begin()
                self._connection.executemany("DELETE FROM kept WHERE number = ?", [(number,) for number in lost])
            self.commit()

    def require_definition(self) -> StudyDefinition:
        """The study's definition, fit to be shown; DseError if it has units that nobody can read."""
        flaw = next(unit_flaws(self.header.definition), "")
        if flaw:
            raise damaged_study(self.path, flaw)
        return self.header.definition

    def ask(self, number: int, requests: Sequence[RunRequest], asked: int) -> None:
        """Note that the sampler's ask *number* of this era wants *requests*, which are new, and *asked* in all so far.

        If it is noted already it must be the same. DseError if it is another one.
        """
        blocks = blocks_of(requests, number, self.header.era)
        stored = self.asks.of(self.header.era, number)
        if stored and stored != blocks:
            what = "the sampler asks for other runs than it did before"
            raise fail(what, Location(str(self.path)), "explore into another folder, or say --fresh")
        if not stored:
            self.asks.add(blocks)
        runs = self.header.earlier + self.asks.numbers - self.header.base
        header = replace(self.header, runs=runs, asked=asked, numbers=self.asks.numbers)
        if not stored or header != self.header:
            self.header = header
            with located(self.path):
                self._begin()
                write_asks(self._connection, () if stored else blocks)
                write_header(self._connection, header)
            self.commit()

    def table(self, numbers: Sequence[int] = ()) -> RunTable:
        """The runs of *numbers* that are stored, or all that are, as columns; DseError if the database is damaged."""
        try:
            with located(self.path):
                return read_table(self._connection, self.header, numbers)
        except (KeyError, ValueError, TypeError) as error:
            raise damaged_study(self.path, str(error)) from error

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
            row = self._connection.execute("SELECT file FROM kept WHERE number = ?", (number,)).fetchone()
        return read_waveforms(self.waveform_folder / self._checked(row[0]), number) if row and row[0] else None

    def add(self, configuration: str, points: Sequence[Sequence[Value]], block: RowBlock) -> None:
        """Store *block*, all of one *configuration*; *points* (n, variables) in the header's order.

        A run that has a row already keeps it. Each is an attempt.
        """
        numbers = block.numbers.tolist()
        cells = (column.tolist() for column in (block.done, block.metrics, block.verdicts, block.margins))
        rows = [
            (
                number,
                configuration,
                str(Outcome.DONE if done else Outcome.FAILED),
                block.problems.get(number, ""),
                *map(cell_of, point),
                *metrics,
                *(str(VERDICTS[code]) for code in verdicts),
                *margins,
            )
            for number, point, done, metrics, verdicts, margins in zip(numbers, points, *cells, strict=True)
        ]
        places = ", ".join("?" * len(columns(self.header)))
        with located(self.path):
            self._begin()
            self._connection.executemany(f"INSERT OR IGNORE INTO runs VALUES ({places})", rows)  # noqa: S608  # marks only
            tries = zip(numbers, repeat(""), block.wall.tolist(), strict=False)
            write_attempts(self._connection, block.maker, tries)
        self.commit_if_due()

    def add_attempts(self, attempts: Sequence[Attempt]) -> None:
        """Store tries that gave no row, or at runs that have one already."""
        with located(self.path):
            self._begin()
            for maker, tries in groupby(attempts, key=lambda attempt: attempt.maker):
                write_attempts(self._connection, maker, ((a.run, a.cause, a.seconds) for a in tries))
        self.commit_if_due()

    def attempts(self) -> list[Attempt]:
        """Every try at a run, in the order they were made."""
        with located(self.path):
            return read_attempts(self._connection)

    def add_kept(self, numbers: Sequence[int], file: str) -> None:
        """Note that the waveforms of *numbers* are in *file*, which is there already; "" if there are none to store."""
        with located(self.path):
            self._begin()
            self._connection.executemany(
                "INSERT OR REPLACE INTO kept VALUES (?, ?)", [(number, file or None) for number in numbers]
            )
        self.commit_if_due()

    def release(self, name: str) -> None:
        """Let the spool of the batch *name* go when what has been added is committed."""
        self._released.add(name)

    def set_problem(self, number: int, problem: str) -> None:
        """Replace what run *number* has to say of itself."""
        with located(self.path):
            self._begin()
            self._connection.execute("UPDATE runs SET problem = ? WHERE number = ?", (problem, number))
        self.commit_if_due()

    def commit_if_due(self) -> None:
        """Commit what has been waiting for a quarter of a second or more."""
        if self._begun is not None and time.monotonic() - self._begun >= _COMMIT_EVERY:
            self.commit()

    def commit(self) -> None:
        """Commit what has been added."""
        if self._begun is not None:
            with located(self.path):
                self._connection.execute("COMMIT")
            self._begun = None
        if self._released:
            clear_spool(self.spool_folder, self._released)
            self._released = set()

    def close(self) -> None:
        """Commit, close, and let others write."""
        with ExitStack() as last:
            if self._lock is not None:
                last.callback(self._lock.release)
            last.callback(self._connection.close)
            self.commit()

    def end(self) -> None:
        """Commit; the study is complete, and nothing is needed aside any more."""
        self.commit()
        shutil.rmtree(self.spool_folder, ignore_errors=True)

    def __enter__(self) -> StudyFolder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @classmethod
    def _connected(cls, path: Path, lock: WriterLock | None) -> StudyFolder:
        connection = connect(path, write=lock is not None)
        try:
            with located(path):
                header, asks = read_header(connection, path)
        except BaseException:
            connection.close()
            raise
        return cls(path, header, connection, asks, lock)

    def take_up(self, definition: StudyDefinition) -> None:
        """Make *definition* the folder's, in a new era if it asks for other runs; DseError if it is another study's."""
        stored = self.header.definition
        different = stored.differences(definition)
        if different:
            raise fail(
                f"holds the results of another study (different: {', '.join(different)})",
                Location(str(self.path)),
                "give another folder with -o, or say --fresh to throw these results away",
            )
        with located(self.path):
            self._begin()
            migrate(self._connection, self.header, self.asks)
        self.recover()
        header = replace(self.header, definition=stored.joined(definition))
        if not stored.samples_alike(definition):
            self.is_extended = True
            era = self.header.era + 1
            earlier = len(self.finished())
            header = replace(header, era=era, base=self.asks.numbers, earlier=earlier, runs=earlier, asked=0)
        if header != self.header:
            with located(self.path):
                self._begin()
                write_header(self._connection, header)
        self.commit()
        self.header = header

    def recover(self) -> None:
        """Store the runs that are in the spool and not here; waveforms stay there until their chunk is complete."""
        finished, kept = self.finished(), self.kept()
        spooled = read_spool(self.spool_folder, self.header.measures, self.header.fingerprint)
        known = {(a.run, a.maker, a.seconds) for a in self.attempts()} if spooled else set()
        needed: set[Path] = set()
        for each in spooled:
            if not self._asked_for(each):
                continue
            numbers, block = each.block.numbers.tolist(), each.block
            fresh = [row for row, number in enumerate(numbers) if number not in finished]
            self.add(each.configuration, [each.points[row] for row in fresh], block.part(np.array(fresh, np.intp)))
            again = [row for row, number in enumerate(numbers) if number in finished]
            tries = [Attempt(numbers[row], block.maker, "", float(block.wall[row])) for row in again]
            self.add_attempts([a for a in tries if (a.run, a.maker, a.seconds) not in known])
            stored = self.table(numbers).block
            order = np.argsort(block.numbers)
            is_same = not block.part(order).differs_from(stored).any()
            # Runs that came out differently are made again, and then found not to be reproducible.
            if is_same and any(not kept.get(number) for number in each.kept):
                needed.add(each.path)
            finished.update(numbers)
        self.commit()
        for file in self.spool_folder.glob(f"*{SPOOLED}"):
            if file not in needed:
                file.unlink(missing_ok=True)

    def forget(self, numbers: AbstractSet[int]) -> None:
        """Take away the rows of the runs *numbers* and what is known of their waveforms; their attempts stay."""
        gone = self.finished() & numbers
        earlier = sum(number < self.header.base for number in gone)
        header = replace(self.header, earlier=self.header.earlier - earlier, runs=self.header.runs - earlier)
        for each in read_spool(self.spool_folder, header.measures, header.fingerprint):
            if gone.intersection(each.block.numbers.tolist()):
                each.path.unlink(missing_ok=True)
        with located(self.path):
            self._begin()
            for table in ("runs", "kept"):
                statement = f"DELETE FROM {table} WHERE number = ?"  # noqa: S608  # one of ours
                self._connection.executemany(statement, [(number,) for number in gone])
            write_header(self._connection, header)
        self.commit()
        self.header = header

    def _asked_for(self, spooled: Spooled) -> bool:
        """Whether the study asked for runs like these; a file of another one may say it is of this."""
        if spooled.variables != self.header.variables:
            return False
        values = (value for point in spooled.points for value in point)
        numbers = spooled.block.numbers.tolist()
        return all(
            isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value) for value in values
        ) and all(self.asks.configuration(number) == spooled.configuration for number in numbers)

    def _checked(self, file: str | None) -> str:
        # The database may come from anywhere: what it names must lie in the folder of waveforms.
        if file and not is_file_name(file):
            raise damaged_study(self.path, f"'{file}' is no file of waveforms")
        return file or ""

    def _numbers(self, query: str) -> set[int]:
        with located(self.path):
            return {number for (number,) in self._connection.execute(query)}

    def _begin(self) -> None:
        if self._begun is None:
            self._connection.execute("BEGIN IMMEDIATE")
            self._begun = time.monotonic()


def _require_room(path: Path) -> None:
    """DseError if *path* is neither a study folder nor a place for one."""
    if path.is_file():
        raise fail("is a file, not a folder", Location(str(path)), "give another folder with -o")
    if not (path / NAME).exists() and path.is_dir() and any(not _is_ours(entry.name) for entry in path.iterdir()):
        raise fail("is not empty and not a study folder", Location(str(path)), "give another folder with -o")


def _is_ours(name: str) -> bool:
    return name in _OURS or name.startswith(f"{NAME}.part")
