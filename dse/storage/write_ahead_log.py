"""Runs that are made and not stored yet: a file per batch and writer, to which each run is appended as it ends.

A record is written at once and stands for itself: a mark, its length and CRC-32, its content. So what was written is
there even if everybody is killed, and one that is torn or damaged is no record. The first tells what the file is of.
Numbers are raw, texts are JSON: a study folder may come from a stranger.
"""

from __future__ import annotations

import json
import math
import mmap
import os
import struct
import zlib
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence, Set as AbstractSet
from contextlib import suppress
from dataclasses import dataclass
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from dse.domain.bench import VERDICTS
from dse.domain.component import Value
from dse.domain.run import Outcome, Run, Waveforms
from dse.json_data import read_json
from dse.storage.rows import Measures, RowBlock, numbers_of
from dse.storage.waveforms import write_waveforms

SUFFIX = ".spool"

_MARK = b"\xd5SPOOL1\n"
_FRAME = struct.Struct("<8sQI")
"""Mark, length of the content, its CRC-32."""

_FLOAT = np.dtype("<f8")

_HEAD = {"name", "maker", "study", "metrics", "requirements", "configuration", "variables"}


class LogWriter:
    """Appends runs of one configuration to a file of its own in *folder*, which is made when the first run comes.

    *name* is that of the batch, *maker* who makes it, *study* the fingerprint of what is studied.
    """

    def __init__(self, folder: Path, name: str, maker: str, measures: Measures, study: str = "") -> None:
        self._folder = folder
        self._head = {"name": name, "maker": maker, "study": study}
        self._measures = measures
        self._file: FileIO | None = None
        self._size = 0
        self._columns: tuple[str, ...] | None = None
        self._note = b""

    def add(self, run: Run, wall: float) -> None:
        """Append *run*, which took *wall* seconds. OSError if it cannot be written; what is there stays whole."""
        begin = b"" if self._file else self._begun(run)
        record = begin + _framed(self._content(run, wall))
        assert self._file is not None  # noqa: S101  # just begun
        try:
            written = self._file.write(record)
            while written < len(record):  # the disk is nearly full: the next try says so
                written += self._file.write(record[written:])
        except OSError:
            with suppress(OSError):
                self._file.truncate(self._size)
            if not self._size:
                self.close()
            raise
        self._size += len(record)

    def alone(self, run: Run, wall: float) -> bytes:
        """What a file with nothing but *run* holds, for `write_logged`."""
        return self._header(run) + _framed(self._content(run, wall))

    def close(self) -> None:
        """Close the file, which stays."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def __enter__(self) -> LogWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _begun(self, run: Run) -> bytes:
        self._file = _new_file(self._folder, self._head["name"])  # open as long as runs come
        self._size = 0
        return self._header(run)

    def _header(self, run: Run) -> bytes:
        self._variables = tuple(run.request.point)
        self._shape = _shape(len(self._variables), self._measures)
        measures = {"metrics": self._measures.metrics, "requirements": self._measures.requirements}
        head = {**self._head, **measures, "configuration": run.request.configuration, "variables": self._variables}
        return _framed(json.dumps(head).encode())

    def _content(self, run: Run, wall: float) -> bytes:
        metrics, margins, verdicts = numbers_of(run, self._measures)
        point, waveforms = run.request.point, run.waveforms
        values = [point[name] for name in self._variables]
        columns = None if waveforms is None else tuple(waveforms.values)
        if run.problem or any(type(value) is not float for value in values):
            note = _note(run.problem, values, columns)
            values = [math.nan] * len(self._variables)
        else:
            note = self._noted(columns)
        rows = -1 if waveforms is None else len(waveforms.time)
        head = (run.request.number, wall, run.outcome is Outcome.DONE, rows, len(note))
        fixed = self._shape.pack(*head, *values, *metrics, *margins, *verdicts)
        if waveforms is None:
            return fixed + note
        arrays = (waveforms.time, *waveforms.values.values())
        return b"".join((fixed, note, *(array.astype(_FLOAT, copy=False).tobytes() for array in arrays)))

    def _noted(self, columns: tuple[str, ...] | None) -> bytes:
        if columns != self._columns:
            self._columns, self._note = columns, _note("", None, columns)
        return self._note


@dataclass(frozen=True, slots=True, eq=False)
class LoggedBatch:
    """What one file of the write-ahead log holds: runs of one *configuration*, made for the batch *name*.

    *points* has for each row of *block* the values of *variables*; *numbers_kept* are the runs that have waveforms.
    """

    path: Path
    name: str
    configuration: str
    variables: tuple[str, ...]
    points: tuple[tuple[Value, ...], ...]
    block: RowBlock
    _places: Mapping[int, _Place]

    @property
    def kept(self) -> AbstractSet[int]:
        """The runs that have waveforms."""
        return self._places.keys()

    def waveforms(self, number: int) -> Waveforms:
        """The waveforms of run *number*; KeyError if it has none."""
        place = self._places[number]
        shape = (len(place.columns) + 1, place.rows)
        time, *values = np.fromfile(self.path, _FLOAT, shape[0] * shape[1], offset=place.offset).reshape(shape)
        return Waveforms(time, dict(zip(place.columns, values, strict=True)))


def write_logged(folder: Path, name: str, content: bytes) -> None:
    """Write what a writer of the batch *name* could not. OSError if it cannot be written here either."""
    with _new_file(folder, name) as file:
        while content:  # the disk is nearly full: the next try says so
            content = content[file.write(content) :]


def read_log(folder: Path, measures: Measures, study: str = "", name: str | None = None) -> list[LoggedBatch]:
    """What the write-ahead log in *folder* holds of *study*, only of the batch *name* if it is given; sorted by name.

    Files of another study, and records that are torn or damaged, are passed over. OSError if one cannot be read.
    """
    found = (_logged(file, measures, study) for file in log_files(folder) if name in (None, _batch_of(file)))
    return [logged for logged in found if logged]


def logged_names(folder: Path) -> set[str]:
    """The batches that the write-ahead log in *folder* holds something of."""
    return {_batch_of(file) for file in log_files(folder)}


def clear_log(folder: Path, names: Container[str]) -> None:
    """Remove what the write-ahead log in *folder* holds of the batches *names*."""
    for file in log_files(folder):
        if _batch_of(file) in names:
            file.unlink(missing_ok=True)


def assemble(file: Path, logged: Iterable[LoggedBatch], numbers: Iterable[int]) -> tuple[int, ...]:
    """Write the waveforms that *logged* has of *numbers* into *file*, as `write_waveforms` does; whose they are.

    Of runs that were made twice the first is taken; they are the same.
    """
    holders: dict[int, LoggedBatch] = {}
    for each in logged:
        for number in each.kept:
            holders.setdefault(number, each)
    kept = tuple(sorted(holders.keys() & set(numbers)))
    if kept:
        write_waveforms(file, ((number, holders[number].waveforms(number)) for number in kept))
    return kept


def log_files(folder: Path) -> list[Path]:
    """The files of the write-ahead log in *folder*, sorted; none if it is not there. OSError if it cannot be read."""
    # Path.glob takes a folder that may not be read for an empty one.
    try:
        return sorted(file for file in folder.iterdir() if file.suffix == SUFFIX)
    except FileNotFoundError:
        return []


def _batch_of(file: Path) -> str:
    return file.name.rsplit(".", 2)[0]


def _new_file(folder: Path, name: str) -> FileIO:
    if not folder.is_dir():
        folder.mkdir(exist_ok=True)
    number = 0
    while True:
        with suppress(FileExistsError):
            return (folder / f"{name}.{os.getpid()}-{number}{SUFFIX}").open("xb", buffering=0)
        number += 1


@dataclass(frozen=True, slots=True)
class _Place:
    """Where in a file *rows* of time and *columns* lie, one after the other."""

    offset: int
    rows: int
    columns: tuple[str, ...]


def _logged(file: Path, measures: Measures, study: str) -> LoggedBatch | None:
    wanted = [_batch_of(file), study, [*measures.metrics], [*measures.requirements]]
    with (
        # It has just been cleared, is empty, which cannot be mapped, or none of ours. What cannot be read for another
        # reason must not pass for runs that have no waveforms.
        suppress(FileNotFoundError, IsADirectoryError, ValueError),
        file.open("rb") as stream,
        mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data,
    ):
        records = _records(data)
        head = _head(data, records)
        if head and [head[key] for key in ("name", "study", "metrics", "requirements")] == wanted:
            return _rows(file, data, records, head, measures)
    return None


def _records(data: mmap.mmap) -> Iterator[tuple[int, int]]:
    """Where the content of each whole record begins and ends."""
    at = data.find(_MARK)
    while at >= 0 and at + _FRAME.size <= len(data):
        _, length, checksum = _FRAME.unpack_from(data, at)
        begin = at + _FRAME.size
        end = begin + length
        if end <= len(data) and _checksum(data, begin, end) == checksum:
            yield begin, end
            at = end
        else:
            at += 1
        at = data.find(_MARK, at)


def _head(data: mmap.mmap, records: Iterator[tuple[int, int]]) -> dict[str, Any] | None:
    place = next(records, None)
    with suppress(ValueError):
        head = read_json(data[slice(*place)]) if place else None
        if isinstance(head, dict) and {*head} == _HEAD and _are_texts(head["variables"]):
            return head if all(isinstance(head[key], str) for key in ("maker", "configuration")) else None
    return None


def _rows(
    file: Path, data: mmap.mmap, records: Iterator[tuple[int, int]], head: Mapping[str, Any], measures: Measures
) -> LoggedBatch:
    variables, m, r = tuple(head["variables"]), len(measures.metrics), len(measures.requirements)
    shape = _shape(len(variables), measures)
    rows: dict[int, _Record] = {}
    for begin, end in records:
        record = _record(data, begin, end, shape, len(variables))
        if record and all(code < len(VERDICTS) for code in record.cells[m + r :]):
            rows.setdefault(record.number, record)
    cells = np.array([row.cells for row in rows.values()], dtype=np.float64).reshape(len(rows), m + 2 * r)
    block = RowBlock(
        np.array([*rows], dtype=np.int64),
        np.array([row.done for row in rows.values()], dtype=np.bool_),
        cells[:, :m],
        cells[:, m + r :].astype(np.uint8),
        cells[:, m : m + r],
        np.array([row.wall for row in rows.values()], dtype=np.float64),
        {number: row.problem for number, row in rows.items() if row.problem},
        head["maker"],
    )
    points = tuple(row.point for row in rows.values())
    places = {number: row.place for number, row in rows.items() if row.place}
    return LoggedBatch(file, head["name"], head["configuration"], variables, points, block, places)


@dataclass(frozen=True, slots=True)
class _Record:
    """A run as it stands in the file; *cells* are metrics, margins and verdicts."""

    number: int
    done: bool
    wall: float
    point: tuple[Value, ...]
    cells: tuple[float, ...]
    problem: str
    place: _Place | None


def _record(data: mmap.mmap, begin: int, end: int, shape: struct.Struct, variables: int) -> _Record | None:
    """The run whose record begins and ends there; None if it is none that `LogWriter` writes."""
    with suppress(struct.error, ValueError, KeyError, TypeError):
        number, wall, done, length, noted, *cells = shape.unpack(data[begin : begin + shape.size])
        behind = begin + shape.size + noted
        note = read_json(data[begin + shape.size : behind], only_finite=False) if noted else {}
        point, problem, columns = note.get("point", cells[:variables]), note.get("problem", ""), note.get("columns", [])
        if length >= 0 and not _are_texts(columns):
            return None
        size = 0 if length < 0 else length * (len(columns) + 1) * _FLOAT.itemsize
        if number >= 0 and behind + size == end and len(point) == variables and isinstance(problem, str):
            place = None if length < 0 else _Place(behind, length, tuple(columns))
            return _Record(number, done, wall, tuple(point), tuple(cells[variables:]), problem, place)
    return None


def _shape(variables: int, measures: Measures) -> struct.Struct:
    """Number, seconds, whether it is done, rows of waveforms (-1: none), size of the note; then the numbers."""
    requirements = len(measures.requirements)
    return struct.Struct(f"<qd?qQ{variables + len(measures.metrics) + requirements}d{requirements}B")


def _note(problem: str, point: Sequence[Value] | None, columns: Sequence[str] | None) -> bytes:
    """What of a run is no number, "" if there is nothing."""
    note: dict[str, Any] = {"problem": problem} if problem else {}
    if point is not None:
        note["point"] = point
    if columns is not None:
        note["columns"] = columns
    return json.dumps(note).encode() if note else b""


def _framed(content: bytes) -> bytes:
    return _FRAME.pack(_MARK, len(content), zlib.crc32(content)) + content


def _checksum(data: mmap.mmap, begin: int, end: int) -> int:
    with memoryview(data) as view, view[begin:end] as content:
        return zlib.crc32(content)


def _are_texts(value: object) -> bool:
    return isinstance(value, list) and all(isinstance(entry, str) for entry in value) and len({*value}) == len(value)
