"""Several study folders of one study become one: those of its shards."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from dse.domain.study import SHARD_FOLDER
from dse.errors import Location, fail
from dse.storage.database.connection import NAME, attachable, located, write_header
from dse.storage.database.files import write_files
from dse.storage.database.row_checksum import stored_checksum
from dse.storage.database.sampler_requests import write_sampler_requests
from dse.storage.database.schema import columns, quoted
from dse.storage.folder import StudyFolder
from dse.storage.reader import StudyReader
from dse.storage.waveform_check import FileFacts, checked
from dse.storage.waveforms import copy_file, link_file


@dataclass(frozen=True, slots=True)
class Merged:
    """*finished* of the study's *runs* are there now; each source had so many *of* them.

    Names of shards that are not there are *absent*; *different* runs were there more than once, with other results.
    """

    runs: int
    finished: int
    of: dict[Path, int]
    absent: tuple[str, ...]
    different: tuple[int, ...]


def shards_in(folder: Path) -> list[Path]:
    """The folders of shards in *folder*, by number."""
    entries = folder.iterdir() if folder.is_dir() else ()
    found = {path: SHARD_FOLDER.fullmatch(path.name) for path in entries if (path / NAME).is_file()}
    numbers = {path: (int(name[2]), int(name[1])) for path, name in found.items() if name}
    return sorted(numbers, key=lambda path: numbers[path])


def merge_studies(target: Path, sources: Sequence[Path]) -> Merged:
    """Store the runs of *sources* in the study folder *target*, which is made or goes on; it can be done again.

    DseError if they are not of one study, or it was extended.
    """
    with ExitStack() as stack:
        readers = [stack.enter_context(StudyReader.open(path)) for path in sources]
        first = readers[0]
        earlier = [stack.enter_context(StudyReader.open(target))] if (target / NAME).exists() else []
        for other in (*readers[1:], *earlier):
            _require_same(first, other)
        merging = stack.enter_context(_Merging.resume(target, first.header.definition))
        different = {number for reader in readers for number in merging.take_in(reader)}
        of = {reader.path: len(reader.finished() | reader.logged()) for reader in readers}
        finished = len(merging.finished())
        return Merged(merging.header.runs, finished, of, _absent(sources), tuple(sorted(different)))


def _require_same(first: StudyReader, other: StudyReader) -> None:
    if first.header.fingerprint != other.header.fingerprint:
        names = first.header.definition.differences(other.header.definition) or ("what it asks for",)
        what = f"is not of the same study as {first.path} (different: {', '.join(names)})"
        raise fail(what, Location(str(other.path)), "explore all shards with the same dse, the same files and options")
    for reader in (first, other):
        if reader.header.era:
            what = "is of a study that was extended after it had begun"
            raise fail(what, Location(str(reader.path)), "merge first, then extend what was merged")
    # Who was stopped early may not have asked.
    asked = [reader.asks.blocks for reader in (first, other) if reader.asks.blocks]
    if len(asked) == 2 and asked[0] != asked[1]:
        raise fail(f"asks for other runs than {first.path}", Location(str(other.path)))


def _absent(sources: Sequence[Path]) -> tuple[str, ...]:
    names = {path.absolute().name for path in sources}
    of = max((int(found[2]) for name in names if (found := SHARD_FOLDER.fullmatch(name))), default=0)
    wanted = (f"shard-{number}-of-{of}" for number in range(1, of + 1))
    return tuple(name for name in wanted if name not in names)


class _Merging(StudyFolder):
    def take_in(self, other: StudyReader) -> tuple[int, ...]:
        """Store what *other* has of the same study; the numbers of the runs that both have and that differ.

        Runs that are here stay as they are. Files of waveforms are linked where that is possible, else copied.
        """
        there = other.table().block  # which is looked through while it is read
        both = sorted(self.finished().intersection(there.numbers.tolist()))
        differ = self.table(both).block.differs_from(other.table(both).block) if both else np.zeros(0, np.bool_)
        kept = other.kept()
        files = self._linked(other, {*kept.values()} - {""})
        self.note_addresses(other.addresses())
        if self.notes() is None and (notes := other.notes()):
            self.note(notes)
        with self._attached(other.path), self._writing() as connection:
            if not self.asks.blocks:
                self.asks = other.asks
                write_sampler_requests(connection, other.asks.blocks)
                counts = {name: getattr(other.header, name) for name in ("runs", "asked", "numbers")}
                self.header = replace(self.header, **counts)
                write_header(connection, self.header, self.asks)
            names = ", ".join(quoted(name) for name in (*columns(self.header), "seal"))
            copy = f"INSERT OR IGNORE INTO runs ({names}) SELECT {names} FROM other.runs"  # noqa: S608  # quoted
            for statement in (copy, *_COPY_ATTEMPTS):
                connection.execute(statement)
            rows = [
                (n, file or None, stored_checksum(n, file)) for n, file in kept.items() if not file or file in files
            ]
            connection.executemany("INSERT OR IGNORE INTO kept VALUES (?, ?, ?)", rows)
            write_files(connection, files)
            connection.execute("COMMIT")
        self.take_logged(other.log_folder)  # whoever made these was killed before they were stored
        self.commit()
        return tuple(number for number, is_other in zip(both, differ.tolist(), strict=True) if is_other)

    def _linked(self, other: StudyReader, names: set[str]) -> dict[str, FileFacts]:
        """Files of *other* that are whole, and here now."""
        known, found = other.files(), {}
        for name in sorted(names):
            source, target = other.waveform_folder / name, self.waveform_folder / name
            facts = checked(source, known.get(name))
            if facts is None:
                continue
            if not (target.exists() or link_file(source, target)):
                copy_file(source, target)
            found[name] = replace(facts, modified=target.stat().st_mtime_ns)
        return found

    @contextmanager
    def _attached(self, path: Path) -> Iterator[None]:
        self.commit()
        with located(path):
            self._connection.execute("ATTACH ? AS other", (attachable(path),))
        try:
            yield
        finally:
            with suppress(sqlite3.Error):
                self._connection.execute("DETACH other")


_COPY_ATTEMPTS = (
    "INSERT OR IGNORE INTO makers (host, process) SELECT host, process FROM other.makers ORDER BY id",
    """CREATE TEMP TABLE here AS
        SELECT run, host, process, cause, seconds FROM main.attempts a JOIN main.makers m ON m.id = a.maker""",
    "CREATE INDEX temp.here_by_run ON here (run)",
    """INSERT INTO main.attempts (run, maker, cause, seconds)
        SELECT a.run, mine.id, a.cause, a.seconds FROM other.attempts a JOIN other.makers theirs ON theirs.id = a.maker
            JOIN main.makers mine ON mine.host = theirs.host AND mine.process = theirs.process
        WHERE NOT EXISTS (SELECT 1 FROM temp.here h WHERE h.run = a.run AND h.host = theirs.host
            AND h.process = theirs.process AND h.cause = a.cause AND h.seconds IS a.seconds)
        ORDER BY a.id""",
    "DROP TABLE temp.here",
)
"""Attempts that are here already, from an earlier merge, are not taken twice."""
