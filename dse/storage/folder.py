"""The study folder: `study.sqlite` with a row per run, and `waveforms/` with the waveforms that were kept."""

from __future__ import annotations

import math
import shutil
import sqlite3
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set as AbstractSet
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from itertools import groupby, repeat
from pathlib import Path
from typing import Self

import numpy as np

from dse.domain.address import Address
from dse.domain.bench import VERDICTS
from dse.domain.component import Value
from dse.domain.definition import StudyDefinition
from dse.domain.provenance import Provenance
from dse.domain.run import Outcome, RunRequest
from dse.domain.study import SHARD_FOLDER
from dse.errors import Location, fail
from dse.storage.attempts import Attempt
from dse.storage.checks import Checks
from dse.storage.database.addresses import write_addresses
from dse.storage.database.attempts import write_attempts
from dse.storage.database.checks import write_checks
from dse.storage.database.connection import (
    NAME,
    create_tables,
    located,
    migrate,
    write_header,
)
from dse.storage.database.files import write_files
from dse.storage.database.header import StudyHeader
from dse.storage.database.provenance import write_provenance
from dse.storage.database.row_checksum import row_checksums, stored_checksum
from dse.storage.database.sampler_requests import SamplerRequests, blocks_of, write_sampler_requests
from dse.storage.database.schema import cell_of, columns, quoted
from dse.storage.lock import LOCK, WRITER, WriterLock
from dse.storage.reader import SPOOL, WAVEFORMS, StudyReader
from dse.storage.rows import RowBlock
from dse.storage.waveform_check import FileFacts, checked, facts_of
from dse.storage.waveforms import PART
from dse.storage.write_ahead_log import LoggedBatch, clear_log, log_files, read_log

_COMMIT_EVERY = 0.25
_OURS = (WAVEFORMS, SPOOL, LOCK, WRITER, "report.html", "replays", "figures")
"""What an earlier study may have left in a folder that is used again."""


class StudyFolder(StudyReader):
    """One study's results, also to write. Use `create`, `resume` or `open`; close it, or use it in a with statement.

    *is_extended* tells that `resume` was given a definition that asks for other runs, *damaged* are the runs whose
    waveforms it did not find as they were kept. There is one writer; any number of readers may look on while it
    writes. What is added is committed every quarter of a second and at the end, so a killed process loses no more
    than that. If something cannot be written, all that was not committed is taken back.
    """

    def __init__(self, path: Path, header: StudyHeader, connection: sqlite3.Connection, asks: SamplerRequests) -> None:
        super().__init__(path, header, connection, asks)
        self.is_extended = False
        self.damaged: frozenset[int] = frozenset()
        self._begun = 0.0
        self._released: set[str] = set()
        self.lock: WriterLock | None = None

    @classmethod
    def create(cls, path: Path, definition: StudyDefinition) -> Self:
        """A new folder for the study of *definition*; DseError if *path* is a file or holds something else already."""
        if (path / NAME).exists():
            raise fail("holds a study already", Location(str(path)), "give another folder with -o, or use --fresh")
        return cls.resume(path, definition)

    @classmethod
    def resume(cls, path: Path, definition: StudyDefinition) -> Self:
        """The folder at *path* to go on with, or a new one; DseError if it holds the results of another study.

        If *definition* only asks for other points or more configurations than the stored one, the study is extended:
        a new era begins. Runs that were logged and not stored are. Waveforms whose file is gone, cut or changed count
        as never kept, so that they are made again. DseError if somebody else writes into the folder.
        """
        _require_room(path)
        with ExitStack() as undo:
            lock = undo.enter_context(WriterLock(path))
            with located(path):
                (path / WAVEFORMS).mkdir(exist_ok=True)
            if not (path / NAME).exists():
                create_tables(path, StudyHeader(definition))
            folder = cls._connected(path, write=True)
            undo.callback(folder.close)
            folder.lock = lock
            with located(path):
                folder.require_structure()
                folder.take_up(definition)
                for torn in (path / WAVEFORMS).glob(f"*{PART}"):
                    torn.unlink(missing_ok=True)
                folder.forget_damaged()
            undo.pop_all()
        return folder

    @staticmethod
    def is_at(path: Path) -> bool:
        """Whether there is a study in *path*, of whatever kind."""
        return (path / NAME).exists()

    @staticmethod
    def discard(path: Path) -> None:
        """Remove the study in *path* and nothing else; DseError if there is something there that is no study."""
        if not (path / NAME).exists():
            if path.exists() and not (path.is_dir() and all(_is_ours(entry.name) for entry in path.iterdir())):
                raise fail("is not a study folder", Location(str(path)), "give another folder with -o")
            return
        with WriterLock(path), located(path):
            for pattern in (f"{NAME}*", f"{WAVEFORMS}/*.parquet", f"{WAVEFORMS}/*{PART}"):
                for file in path.glob(pattern):
                    file.unlink()
            shutil.rmtree(path / SPOOL, ignore_errors=True)

    def forget_damaged(self) -> None:
        """Take waveforms whose file is gone, cut or changed as never kept."""
        known, kept = self.files(), self.kept()
        now = {file: checked(self.waveform_folder / file, known.get(file)) for file in {*kept.values()} - {""}}
        self.damaged = frozenset(number for number, file in kept.items() if file and not now[file])
        news = {file: facts for file, facts in now.items() if facts and facts != known.get(file)}
        if self.damaged or news:
            with self._writing() as connection:
                connection.executemany("DELETE FROM kept WHERE number = ?", [(number,) for number in self.damaged])
                write_files(connection, news)
            self.commit()

    def ask(self, number: int, requests: Iterable[RunRequest], asked: int) -> None:
        """Note that the sampler's ask *number* of this era wants *requests*, which are new, and *asked* in all so far.

        If it is noted already it must be the same. DseError if it is another one.
        """
        blocks = blocks_of(requests, number, self.header.era)
        stored = self.asks.of(self.header.era, number)
        if stored and stored != blocks:
            what = "the sampler asks for other runs than it did before"
            raise fail(what, Location(str(self.path)), "explore into another folder, or use --fresh")
        if not stored:
            self.asks.add(blocks)
        runs = self.header.earlier + self.asks.numbers - self.header.base
        header = replace(self.header, runs=runs, asked=asked, numbers=self.asks.numbers)
        if not stored or header != self.header:
            self.header = header
            with self._writing() as connection:
                write_sampler_requests(connection, () if stored else blocks)
                write_header(connection, header, self.asks)
            self.commit()

    def join(self, definition: StudyDefinition) -> None:
        """Have the configurations of *definition*, too, which is else the one that is stored."""
        header = replace(self.header, definition=self.header.definition.joined(definition))
        with self._writing() as connection:
            write_header(connection, header, self.asks)
        self.commit()
        self.header = header

    def note(self, notes: Provenance) -> None:
        """Keep *notes* in place of what was kept."""
        if notes != self.notes():
            with self._writing() as connection:
                write_provenance(connection, notes)
            self.commit()

    def note_addresses(self, addresses: Mapping[str, Address]) -> None:
        """Note *addresses* of configurations of which none is known yet."""
        there = self.addresses()
        fresh = {name: address for name, address in addresses.items() if name not in there}
        if fresh:
            with self._writing() as connection:
                write_addresses(connection, fresh)
            self.commit()

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
        if not rows:
            return
        checked = [
            (*row, checksum)
            for row, checksum in zip(rows, row_checksums([*zip(*rows, strict=True)]).tolist(), strict=True)
        ]
        places = ", ".join("?" * len(checked[0]))
        with self._writing() as connection:
            connection.executemany(f"INSERT OR IGNORE INTO runs VALUES ({places})", checked)  # noqa: S608  # marks only
            tries = zip(numbers, repeat(""), block.wall.tolist(), strict=False)
            write_attempts(connection, block.maker, tries)
        self.commit_if_due()

    def add_attempts(self, attempts: Sequence[Attempt]) -> None:
        """Store tries that gave no row, or at runs that have one already."""
        with self._writing() as connection:
            for maker, tries in groupby(attempts, key=lambda attempt: attempt.maker):
                write_attempts(connection, maker, ((a.run, a.cause, a.seconds) for a in tries))
        self.commit_if_due()

    def add_checks(self, checks: Checks) -> None:
        """Store *checks* of runs that are there; a run that has one keeps it."""
        with self._writing() as connection:
            write_checks(connection, checks)
        self.commit_if_due()

    def add_kept(self, numbers: Sequence[int], file: str) -> FileFacts | None:
        """Note that the waveforms of *numbers* are in *file*, which is there already; "" if there are none to store.

        What is known of the file now.
        """
        facts = None
        with self._writing() as connection:
            rows = [(number, file or None, stored_checksum(number, file)) for number in numbers]
            connection.executemany("INSERT OR REPLACE INTO kept VALUES (?, ?, ?)", rows)
            if file:
                facts = facts_of(self.waveform_folder / file)
                write_files(connection, {file: facts})
        self.commit_if_due()
        return facts

    def release(self, name: str) -> None:
        """Let the write-ahead log of the batch *name* go when what has been added is committed."""
        self._released.add(name)

    def set_problem(self, number: int, problem: str) -> None:
        """Replace what run *number* has to say of itself."""
        with self._writing() as connection:
            connection.execute("UPDATE runs SET problem = ? WHERE number = ?", (problem, number))
            choice = ", ".join(map(quoted, columns(self.header)))
            query = f"SELECT {choice} FROM runs WHERE number = ?"  # noqa: S608  # quoted
            for row in connection.execute(query, (number,)).fetchall():
                checksum = int(row_checksums([(cell,) for cell in row])[0])
                connection.execute("UPDATE runs SET seal = ? WHERE number = ?", (checksum, number))
        self.commit_if_due()

    def commit_if_due(self) -> None:
        """Commit what has been waiting for a quarter of a second or more."""
        if self._connection.in_transaction and time.monotonic() - self._begun >= _COMMIT_EVERY:
            self.commit()

    def commit(self) -> None:
        """Commit what has been added."""
        if self._connection.in_transaction:
            with self._writing() as connection:
                connection.execute("COMMIT")
        if self._released:
            with suppress(OSError):  # what stays is known to be stored
                clear_log(self.log_folder, self._released)
            self._released.clear()

    def close(self) -> None:
        """Commit, close, and let others write."""
        with ExitStack() as last:
            if self.lock is not None:
                last.callback(self.lock.release)
            last.callback(super().close)
            self.commit()

    def end(self) -> None:
        """Commit; the study is complete, and nothing is needed aside any more."""
        self.commit()
        shutil.rmtree(self.log_folder, ignore_errors=True)

    def take_up(self, definition: StudyDefinition) -> None:
        """Make *definition* the folder's, in a new era if it asks for other runs; DseError if it is another study's."""
        stored = self.header.definition
        different = stored.differences(definition)
        if different:
            raise fail(
                f"holds the results of another study (different: {', '.join(different)})",
                Location(str(self.path)),
                "give another folder with -o, or use --fresh to throw these results away",
            )
        with self._writing() as connection:
            migrate(connection, self.header, self.asks)
        self.recover()
        header = replace(self.header, definition=stored.joined(definition))
        if not stored.samples_alike(definition):
            self.is_extended = True
            era = self.header.era + 1
            earlier = len(self.finished())
            header = replace(header, era=era, base=self.asks.numbers, earlier=earlier, runs=earlier, asked=0)
        if header != self.header:
            with self._writing() as connection:
                write_header(connection, header, self.asks)
        self.commit()
        self.header = header

    def recover(self) -> None:
        """Store the runs that are in the write-ahead log and not here; waveforms stay there until their chunk is
        complete."""
        needed = self.take_logged(self.log_folder)
        self.commit()
        for file in log_files(self.log_folder):
            if file not in needed:
                file.unlink(missing_ok=True)

    def take_logged(self, log_folder: Path) -> set[Path]:
        """Store the runs that are in the folder *write-ahead log* and not here; the files whose waveforms are still
        needed."""
        finished, kept = self.finished(), self.kept()
        logged = read_log(log_folder, self.header.measures, self.header.fingerprint)
        known = {(a.run, a.maker, a.seconds) for a in self.attempts()} if logged else set()
        needed: set[Path] = set()
        for each in logged:
            if not self._asked_for(each):
                continue
            numbers, block = each.block.numbers.tolist(), each.block
            fresh = [row for row, number in enumerate(numbers) if number not in finished]
            points = [dict(zip(each.variables, each.points[row], strict=True)) for row in fresh]
            ordered = [[point.get(name, math.nan) for name in self.header.variables] for point in points]
            self.add(each.configuration, ordered, block.part(np.array(fresh, np.intp)))
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
        return needed

    def forget(self, numbers: AbstractSet[int]) -> None:
        """Take away the rows of the runs *numbers* and what is known of their waveforms; their attempts stay."""
        gone = self.finished() & numbers
        earlier = sum(number < self.header.base for number in gone)
        header = replace(self.header, earlier=self.header.earlier - earlier, runs=self.header.runs - earlier)
        for each in read_log(self.log_folder, header.measures, header.fingerprint):
            if gone.intersection(each.block.numbers.tolist()):
                each.path.unlink(missing_ok=True)
        with self._writing() as connection:
            for table in ("runs", "kept", "checks"):
                statement = f"DELETE FROM {table} WHERE number = ?"  # noqa: S608  # one of ours
                connection.executemany(statement, [(number,) for number in gone])
            write_header(connection, header, self.asks)
        self.commit()
        self.header = header

    def forget_kept(self) -> None:
        """Delete all waveforms, and take away what is known of them."""
        files = {*self.kept().values()} - {""}
        with self._writing() as connection:
            connection.execute("DELETE FROM kept")
        self.commit()
        self._delete(self.waveform_folder / file for file in files)

    def _delete(self, files: Iterable[Path]) -> None:
        for file in files:
            file.unlink(missing_ok=True)

    def _asked_for(self, logged: LoggedBatch) -> bool:
        """Whether the study asked for runs like these; a file of another one may say it is of this."""
        header = self.header
        if logged.configuration not in header.configurations:
            return False
        has = header.has(logged.configuration).tolist()
        if logged.variables != tuple(name for name, there in zip(header.variables, has, strict=True) if there):
            return False
        values = (value for point in logged.points for value in point)
        numbers = logged.block.numbers.tolist()
        return all(
            isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value) for value in values
        ) and all(self.asks.configuration(number) == logged.configuration for number in numbers)

    @contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        """The transaction to write in, begun if there is none; if something fails, all of it is taken back."""
        try:
            with located(self.path):
                if not self._connection.in_transaction:
                    self._connection.execute("BEGIN IMMEDIATE")
                    self._begun = time.monotonic()
                yield self._connection
        except Exception:
            self._take_back()
            raise

    def _take_back(self) -> None:
        self._released.clear()
        with suppress(sqlite3.Error):  # SQLite may have done so
            self._connection.execute("ROLLBACK")


def _require_room(path: Path) -> None:
    """DseError if *path* is neither a study folder nor a place for one."""
    if path.is_file():
        raise fail("is a file, not a folder", Location(str(path)), "give another folder with -o")
    if not (path / NAME).exists() and path.is_dir() and any(not _is_ours(entry.name) for entry in path.iterdir()):
        raise fail("is not empty and not a study folder", Location(str(path)), "give another folder with -o")


def _is_ours(name: str) -> bool:
    return name in _OURS or name.startswith(f"{NAME}.part") or SHARD_FOLDER.fullmatch(name) is not None
