"""Waveforms of a chunk of runs in one Parquet file, one row group per run."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterable, Iterator, Sequence, Set as AbstractSet
from contextlib import contextmanager, suppress
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.run import Waveforms
from dse.errors import Location, fail
from dse.storage.disk import unreadable

PART = ".part"
"""Suffix of a file that is still being written."""

AGAIN = "delete the file if it is there: the same explore command makes its waveforms again"


def waveform_file(first: int, last: int) -> str:
    """Name of the file for the chunk of runs *first* to *last*, both included."""
    return f"runs-{first:08d}-{last:08d}.parquet"


def is_file_name(text: str) -> bool:
    """Whether *text* is a name that `waveform_file` gives, and so no path to somewhere else."""
    return re.fullmatch(r"runs-[0-9]{8,}-[0-9]{8,}\.parquet", text) is not None


def write_waveforms(file: Path, runs: Iterable[tuple[int, Waveforms]]) -> None:
    """Write *runs* (number, waveforms), one or more, sorted by number, recorded alike. The file is there whole or not.

    Columns: run (int32), time in seconds, one float64 column per recorded variable in SI. ValueError if the
    runs recorded different variables.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    runs = iter(runs)
    first, recorded = next(runs)
    names = list(recorded.values)
    schema = pa.schema([("run", pa.int32()), ("time", pa.float64()), *((name, pa.float64()) for name in names)])
    # Streams of ours: Arrow cannot name a file whose path is no UTF-8.
    with (
        _placed(file) as aside,
        aside.open("wb") as stream,
        pq.ParquetWriter(stream, schema, compression="zstd", use_dictionary=False) as writer,
    ):
        for number, waveforms in chain([(first, recorded)], runs):
            if list(waveforms.values) != names:
                raise ValueError(f"run {number} recorded other variables than run {first}")
            run = np.full(len(waveforms.time), number, dtype=np.int32)
            columns: list[NDArray[Any]] = [run, waveforms.time, *(waveforms.values[name] for name in names)]
            arrays = [_arrow(column, field.type) for column, field in zip(columns, schema, strict=True)]
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema), row_group_size=max(len(run), 1))


def gather_waveforms(
    file: Path, numbers: Sequence[int], places: Sequence[tuple[Path, int]], columns: Sequence[str]
) -> None:
    """Write *file* as `write_waveforms` does with *columns*, from runs that were kept already; same bytes.

    The waveforms of each of *numbers* are at its place: a file, and the number they have there. A file that is all
    that is wanted gets a second name, where the file system has such. DseError if one is missing or damaged.
    """
    (first, _), *_ = places
    same = [(first, number) for number in numbers]
    if list(places) == same and _is_just(first, numbers, columns) and link_file(first, file):
        return
    read = ((number, read_waveforms(*place)) for number, place in zip(numbers, places, strict=True))
    write_waveforms(file, [(n, Waveforms(w.time, {name: w.values[name] for name in columns})) for n, w in read])


def link_file(source: Path, target: Path) -> bool:
    """Give *source* the second name *target*, in place of what is there; False where the file system has no such."""
    aside = _aside(target)
    try:
        aside.unlink(missing_ok=True)
        aside.hardlink_to(source)
        aside.replace(target)
    except OSError:
        return False
    finally:
        # Where the two are one file already, renaming leaves both names.
        with suppress(OSError):
            aside.unlink(missing_ok=True)
    return True


def copy_file(source: Path, target: Path) -> None:
    """Copy *source*, with its times, to *target*, which is there whole or not."""
    with _placed(target) as aside:
        shutil.copy2(source, aside)


@contextmanager
def _placed(file: Path) -> Iterator[Path]:
    """Gives the path to write what is to become *file*; nothing is left of what could not be written."""
    aside = _aside(file)
    try:
        yield aside
        aside.replace(file)
    finally:
        with suppress(OSError):
            aside.unlink(missing_ok=True)


def _aside(file: Path) -> Path:
    # Its own name per process: a second writer of the same chunk writes the same bytes, but not into this file.
    return file.with_name(f"{file.name}.{os.getpid()}{PART}")


def _is_just(file: Path, numbers: Sequence[int], columns: Sequence[str]) -> bool:
    """Whether *file* holds *numbers* and nothing else, as it would be written now."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        with file.open("rb") as stream, pq.ParquetFile(stream) as parquet:
            told = parquet.metadata
            is_ours = told.created_by == f"parquet-cpp-arrow version {pa.__version__}"
            names = parquet.schema_arrow.names
            return bool(is_ours and told.num_row_groups == len(numbers) and names == ["run", "time", *columns])
    except (OSError, pa.ArrowException):
        return False


def read_waveforms(file: Path, number: int) -> Waveforms:
    """The waveforms of run *number*; DseError if the file is missing, damaged or does not hold the run."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        with file.open("rb") as stream, pq.ParquetFile(stream, pre_buffer=False) as parquet:
            group = _group_of(parquet, number)
            table = None if group is None else _read(parquet, group)
    except (OSError, pa.ArrowException) as error:
        raise unreadable(f"waveforms of run {number}", file, error, AGAIN) from error
    if table is None:
        raise fail(f"there are no waveforms of run {number} in it", Location(str(file)), AGAIN)
    return _waveforms(table, file)


def read_chosen_waveforms(file: Path, numbers: AbstractSet[int], names: AbstractSet[str]) -> dict[int, Waveforms]:
    """Those of the runs *numbers* that are in *file*, with those of the variables *names* that were recorded.

    DseError if the file is missing or damaged, as far as is read.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        with file.open("rb") as stream, pq.ParquetFile(stream, pre_buffer=False) as parquet:
            told = parquet.metadata
            every = ((group, _number_of(parquet, group)) for group in range(told.num_row_groups))
            groups = {group: number for group, number in every if number is not None and number in numbers}
            columns = ["run", "time", *(name for name in parquet.schema_arrow.names if name in names)]
            # One call for all: it takes half the time of one for each.
            table = parquet.read_row_groups([*groups], columns, use_threads=False) if groups else None
            ends = np.cumsum([told.row_group(group).num_rows for group in groups])[:-1]
    except (OSError, pa.ArrowException) as error:
        raise unreadable("waveforms", file, error, AGAIN) from error
    if table is None:
        return {}
    whole = _waveforms(table, file)
    times = np.split(whole.time, ends)
    values = {name: np.split(whole.values[name], ends) for name in columns[2:]}
    return {
        number: Waveforms(times[place], {name: parts[place] for name, parts in values.items()})
        for place, number in enumerate(groups.values())
    }


def _read(parquet: Any, group: int) -> Any:
    # By this thread alone, and nothing ahead: a thread of Arrow's that lets go of a buffer of Python's while Python
    # ends aborts the process (std::terminate), after all was done.
    return parquet.read_row_group(group, use_threads=False)


def _waveforms(table: Any, file: Path) -> Waveforms:
    """*table* as waveforms; DseError unless its columns are those that `write_waveforms` writes."""
    import pyarrow as pa

    kinds = {field.name: field.type for field in table.schema}
    doubles = [name for name in kinds if name != "run"]
    strange = (
        len(kinds) != table.num_columns
        or kinds.get("run") != pa.int32()
        or "time" not in kinds
        or any(kinds[name] != pa.float64() for name in doubles)
        or any(column.null_count for column in table.columns)
    )
    if strange:
        raise fail("these are no waveforms of a study", Location(str(file)), AGAIN)
    arrays = {name: _numpy(table.column(name)) for name in doubles}
    return Waveforms(arrays.pop("time"), arrays)


# pyarrow's own conversions would import pandas, half a second in each worker; the buffers are the same bytes.


def _numpy(column: Any) -> NDArray[np.float64]:
    """A float64 column without gaps as an array."""
    chunks = [
        np.frombuffer(chunk.buffers()[1], np.float64, len(chunk), chunk.offset * np.dtype(np.float64).itemsize)
        for chunk in column.chunks
    ]
    return np.concatenate(chunks) if len(chunks) != 1 else chunks[0]


def _arrow(column: NDArray[Any], kind: Any) -> Any:
    import pyarrow as pa

    return pa.Array.from_buffers(kind, len(column), [None, pa.py_buffer(np.ascontiguousarray(column))])


def _group_of(parquet: Any, number: int) -> int | None:
    for group in range(parquet.metadata.num_row_groups):
        if _number_of(parquet, group) == number:
            return group
    return None


def _number_of(parquet: Any, group: int) -> int | None:
    statistics = parquet.metadata.row_group(group).column(0).statistics
    return statistics.min if statistics is not None and statistics.has_min_max else None


def read_all_waveforms(file: Path) -> Iterator[tuple[int, Waveforms]]:
    """Every run in *file* with its waveforms, in order; DseError if the file is missing or damaged."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        with file.open("rb") as stream, pq.ParquetFile(stream, pre_buffer=False) as parquet:
            for group in range(parquet.metadata.num_row_groups):
                table = _read(parquet, group)
                waveforms = _waveforms(table, file)
                if table.num_rows:
                    yield table.column("run")[0].as_py(), waveforms
    except (OSError, pa.ArrowException) as error:
        raise unreadable("waveforms", file, error, AGAIN) from error
