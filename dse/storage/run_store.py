"""Runs that were made before, by what decides them: a folder that any number of processes read and add to.

Every key has a folder of its own, with a file of records that is only ever appended to. A record is written at once and
is good or bad as a whole; what is damaged, cut off or cannot be read counts as absent, what cannot be written is not
kept. Waveforms are not copied: a file of a study's gets a second name here, or is looked for where it lies.
"""

from __future__ import annotations

import json
import os
import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from dse.domain.address import NAME_BYTES
from dse.storage.rows import RowBlock
from dse.storage.waveform_check import digest_of
from dse.storage.waveforms import link_file

Names = NDArray[np.uint8]
"""What names n runs, (n, 16)."""

_MAGIC = b"dse runs\x01\r\n\x00"
_HEAD = struct.Struct("<12sBIIIQI")
_RECORDS = "records"
_ROWS, _WAVEFORMS, _WITHDRAWN = range(3)


@dataclass(frozen=True, slots=True)
class _Record:
    """What one call added: n names, with m metrics and r requirements if these are rows."""

    kind: int
    names: Names
    metrics: int
    requirements: int
    content: bytes


class RunStore:
    """The runs in *folder*, which need not exist yet."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._whole: dict[str, Path | None] = {}

    def add(self, key: str, names: Names, block: RowBlock) -> bool:
        """Add the runs of *block* under their *names*, metrics and requirements sorted by name; False if it cannot.

        Whoever looks for them finds the last that was added.
        """
        m, r = block.metrics.shape[1], block.verdicts.shape[1]
        rows = {number: row for row, number in enumerate(block.numbers.tolist())}
        problems = {rows[number]: text for number, text in block.problems.items()}
        parts = (block.metrics, block.margins, block.wall, block.verdicts)
        content = b"".join(np.ascontiguousarray(part).tobytes() for part in parts)
        return self._append(key, _Record(_ROWS, names, m, r, content + json.dumps(problems).encode()))

    def withdraw(self, key: str, names: Names) -> None:
        """Take back the runs of these *names*: they gave another result when they were made again."""
        self._append(key, _Record(_WITHDRAWN, names, 0, 0, b""))

    def find(self, key: str, names: Names, metrics: int, requirements: int) -> tuple[NDArray[np.intp], RowBlock]:
        """The rows of *names* of which a run is there, ascending, and these runs, numbered by their rows."""
        n = len(names) if (self._entry(key) / _RECORDS).exists() else 0
        names = names[:n]
        sought = _Sought(names)
        there = np.zeros(n, dtype=np.bool_)
        values, margins = np.full((n, metrics), np.nan), np.full((n, requirements), np.nan)
        verdicts, wall = np.zeros((n, requirements), dtype=np.uint8), np.full(n, np.nan)
        problems: dict[int, str] = {}
        for record in self._records(key):
            if record.kind == _WAVEFORMS:
                continue
            mine, theirs = sought.hits(record.names).T
            there[mine] = record.kind == _ROWS and (record.metrics, record.requirements) == (metrics, requirements)
            if len(mine) and there[mine[0]]:
                columns = _columns(record)
                values[mine], margins[mine] = columns.values[theirs], columns.margins[theirs]
                verdicts[mine], wall[mine] = columns.verdicts[theirs], columns.wall[theirs]
                problems |= zip(
                    mine.tolist(), (columns.problems.get(str(at), "") for at in theirs.tolist()), strict=True
                )
        rows = np.flatnonzero(there)
        said = {row: problem for row, problem in problems.items() if problem}
        return rows, RowBlock(np.arange(n), there, values, verdicts, margins, wall, said).part(rows)

    def seconds(self, key: str) -> tuple[float, int]:
        """How many seconds runs of *key* took in all, and how many they were."""
        seconds, runs = 0.0, 0
        for record in self._records(key):
            if record.kind == _ROWS:
                wall = _columns(record).wall
                known = wall[np.isfinite(wall)]
                seconds, runs = seconds + float(known.sum()), runs + len(known)
        return seconds, runs

    def add_waveforms(self, key: str, names: Names, numbers: Sequence[int], file: Path, digest: str) -> None:
        """Note that the waveforms of the runs of *names* are in *file* with this SHA-256, there under *numbers*."""
        try:
            here = self._entry(key) / f"{digest}.parquet"
            here.parent.mkdir(parents=True, exist_ok=True)
            if not here.exists():
                link_file(file, here)
        except OSError:
            return
        place = {"digest": digest, "place": str(file.resolve()), "numbers": list(map(int, numbers))}
        self._append(key, _Record(_WAVEFORMS, names, 0, 0, json.dumps(place).encode()))

    def places(self, key: str, names: Names) -> list[tuple[Path, int] | None]:
        """The file with the waveforms of each of *names*, and the number they have there; None where there is none."""
        sought = _Sought(names)
        found: list[tuple[str, str, int] | None] = [None] * len(names)
        for record in self._records(key):
            if record.kind == _WAVEFORMS:
                told = json.loads(record.content)
                for row, at in sought.hits(record.names).tolist():
                    found[row] = (told["digest"], told["place"], told["numbers"][at])
        files = [one and self._file(key, one[0], one[1]) for one in found]
        return [(file, one[2]) if one and file else None for one, file in zip(found, files, strict=True)]

    def _file(self, key: str, digest: str, place: str) -> Path | None:
        """The file that has this *digest*, here or in its study."""
        if digest not in self._whole:
            candidates = (self._entry(key) / f"{digest}.parquet", Path(place))
            self._whole[digest] = next((file for file in candidates if _has_digest(file, digest)), None)
        return self._whole[digest]

    def _entry(self, key: str) -> Path:
        return self.folder / key

    def _append(self, key: str, record: _Record) -> bool:
        file = self._entry(key) / _RECORDS
        payload = np.ascontiguousarray(record.names).tobytes() + record.content
        whole = _checked(record.kind, len(record.names), record.metrics, record.requirements, payload)
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            # Appended in one piece: what others write at the same time comes before or after it.
            handle = os.open(file, os.O_WRONLY | os.O_APPEND | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o666)
            try:
                return os.write(handle, whole) == len(whole)
            finally:
                os.close(handle)
        except OSError:
            return False

    def _records(self, key: str) -> Iterator[_Record]:
        """The good records of *key*, oldest first."""
        path = self._entry(key) / _RECORDS
        try:
            with path.open("rb") as file:
                os.utime(path.parent)  # what is used is not old
                size = os.fstat(file.fileno()).st_size
                at = 0
                while at >= 0:
                    file.seek(at)
                    record = _read_record(file, size - at)
                    if record is not None:
                        yield record
                        at = file.tell()
                    else:
                        # After a torn record another one may have been appended.
                        file.seek(at + 1)
                        beyond = file.read(size - at).find(_MAGIC)
                        at = at + 1 + beyond if beyond >= 0 else -1
        except OSError:
            return


@dataclass(frozen=True, slots=True)
class _Columns:
    values: NDArray[np.float64]
    margins: NDArray[np.float64]
    wall: NDArray[np.float64]
    verdicts: NDArray[np.uint8]
    problems: dict[str, str]


class _Sought:
    """Names that are looked for, so sorted that many others are quickly compared with them."""

    def __init__(self, names: Names) -> None:
        self._names = names
        heads = _heads(names)
        self._order = np.argsort(heads, kind="stable")
        self._sorted = heads[self._order]

    def hits(self, names: Names) -> NDArray[np.intp]:
        """Pairs (row here, row there) of the names that both have."""
        if not len(self._names):
            return np.zeros((0, 2), dtype=np.intp)
        heads = _heads(names)
        at = np.minimum(np.searchsorted(self._sorted, heads), len(self._sorted) - 1)
        theirs = np.flatnonzero(self._sorted[at] == heads)
        mine = self._order[at[theirs]]
        same = (self._names[mine] == names[theirs]).all(axis=1)
        return np.column_stack((mine[same], theirs[same]))


def _heads(names: Names) -> NDArray[np.uint64]:
    return np.ascontiguousarray(names[:, :8]).view(np.uint64).reshape(-1)


def _checked(kind: int, n: int, metrics: int, requirements: int, payload: bytes) -> bytes:
    check = _check(payload, kind, n, metrics, requirements)
    return _HEAD.pack(_MAGIC, kind, n, metrics, requirements, len(payload), check) + payload


def _check(payload: bytes, *head: int) -> int:
    return zlib.crc32(payload, zlib.crc32(repr(head).encode()))


def _read_record(file: BinaryIO, room: int) -> _Record | None:
    """The record that begins here, if it is good and no longer than *room* bytes."""
    head = file.read(_HEAD.size)
    if len(head) < _HEAD.size:
        return None
    magic, kind, n, metrics, requirements, length, check = _HEAD.unpack(head)
    if magic != _MAGIC or length > room or n * NAME_BYTES > length:
        return None
    payload = file.read(length)
    if _check(payload, kind, n, metrics, requirements) != check:
        return None
    names = np.frombuffer(payload, dtype=np.uint8, count=n * NAME_BYTES).reshape(n, NAME_BYTES)
    return _Record(kind, names, metrics, requirements, payload[n * NAME_BYTES :])


def _columns(record: _Record) -> _Columns:
    n, m, r = len(record.names), record.metrics, record.requirements
    numbers = np.frombuffer(record.content, dtype="<f8", count=n * (m + r + 1))
    at = numbers.nbytes
    verdicts = np.frombuffer(record.content, dtype=np.uint8, count=n * r, offset=at).reshape(n, r)
    values, margins, wall = np.split(numbers, (n * m, n * (m + r)))
    problems: dict[str, str] = json.loads(record.content[at + n * r :])
    return _Columns(values.reshape(n, m), margins.reshape(n, r), wall, verdicts, problems)


def _has_digest(file: Path, digest: str) -> bool:
    try:
        return file.is_file() and digest_of(file) == digest
    except OSError:
        return False
