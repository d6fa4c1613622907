"""A drive as a file: Parquet with a column for each thing the driver in the loop put out, and what else is known as
JSON in its head.

Files come from anybody: what is no drive is refused by name, before much of it is read.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from hashlib import sha256
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dse.domain.component import Value
from dse.domain.drive import Drive, Pace
from dse.errors import DseError, Location, fail
from dse.formats import shown
from dse.json_data import read_json, read_noun
from dse.scratch import write_whole

SUFFIX = ".parquet"
LONGEST_NAME = 60
"""Characters of what a driver calls themself."""

_KEY = b"dse.drive"
_VERSION = 1
_MOST_BYTES = 200_000_000
_MOST_ROWS = 400_000
_MOST_COLUMNS = 4_000
_MOST_NUMBERS = 20_000_000
_MOST_HEAD = 2_000_000
_TIME = "time"
_WORD = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_\-]{0,99}")
_PORT = re.compile(r"[A-Za-z_][A-Za-z0-9_.\[\],]{0,199}")
_ID = 8


def drive_id(drive: Drive) -> str:
    """Eight hexadecimal digits that follow from all that is in *drive*: equal drives are one."""
    return _digest(drive)[:_ID]


def _digest(drive: Drive) -> str:
    digest = sha256(_head(drive))
    for column in (drive.time, *(drive.inputs[name] for name in sorted(drive.inputs))):
        digest.update(np.ascontiguousarray(column, "<f8").tobytes())
    return digest.hexdigest()


def driver_name(text: str) -> str:
    """What somebody calls themself, as it can be kept: one line of visible characters. Raises DseError."""
    name = " ".join(text.split())
    if not name or len(name) > LONGEST_NAME or not name.isprintable():
        what = f"a driver's name has 1 to {LONGEST_NAME} visible characters"
        raise fail(f"{what}, not {name[:LONGEST_NAME]!r}" if name else what)
    return name


def write_drive(folder: Path, drive: Drive) -> Path:
    """Keep *drive* in *folder*, whole or not at all; its name is its id. Raises DseError if it is none."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    path = folder / f"{drive_id(drive)}{SUFFIX}"
    _require(drive, path)
    names = sorted(drive.inputs)
    columns = [drive.time, *(drive.inputs[name] for name in names)]
    arrays = [pa.array(np.ascontiguousarray(column, np.float64)) for column in columns]
    table = pa.Table.from_arrays(arrays, [_TIME, *names]).replace_schema_metadata({_KEY: _head(drive)})
    if path.exists() and _digest(read_drive(path)) != _digest(drive):
        raise fail("is another drive of the same id", Location(shown(path)), "keep one of them in another folder")
    written = BytesIO()
    pq.write_table(table, written, compression="zstd")
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(path, written.getvalue())
    return path


def read_drive(path: Path) -> Drive:
    """The drive in the file *path*. Raises DseError with what is wrong if it holds none."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    here = Location(shown(path))
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise fail(f"is larger than {_MOST_BYTES // 1_000_000} MB: no drive", here)
        with path.open("rb") as stream, pq.ParquetFile(stream, pre_buffer=False) as parquet:
            names = list(parquet.schema_arrow.names)
            kinds = {str(kind) for kind in parquet.schema_arrow.types}
            rows, head = parquet.metadata.num_rows, (parquet.schema_arrow.metadata or {}).get(_KEY)
            if head is None:
                raise fail("is not a drive: it has no mark of one", here, "drives are written by 'dse drive'")
            if len(head) > _MOST_HEAD or rows > _MOST_ROWS or len(names) > _MOST_COLUMNS:
                raise fail(f"has {rows:,} rows of {len(names):,} columns: too large for a drive", here)
            if rows * len(names) > _MOST_NUMBERS:
                raise fail(f"has {rows * len(names):,} numbers: too large for a drive", here)
            if kinds != {"double"} or names[:1] != [_TIME] or len({*names}) < len(names):
                raise fail("is not a drive: it has other columns than 'time' and numbers by name", here)
            table = parquet.read(use_threads=False)
    except (OSError, pa.ArrowException) as error:
        raise fail(f"cannot be read: {str(error).splitlines()[0]}", here, "copy it again") from None
    if any(column.null_count for column in table.columns):
        raise fail("has rows without a value", here)
    columns = {name: np.array(table.column(place).to_numpy()) for place, name in enumerate(names)}
    time = columns.pop(_TIME)
    drive = _of_head(head, time, columns, here)
    _require(drive, path)
    return drive


def _head(drive: Drive) -> bytes:
    told = {
        "version": _VERSION,
        "bench": drive.bench,
        "configuration": drive.configuration,
        "driver": drive.driver,
        "step": drive.step,
        "settings": dict(drive.settings),
        "pace": asdict(drive.pace),
        "bits": dict(drive.bits),
    }
    return json.dumps(told, sort_keys=True).encode()


@dataclass(frozen=True, slots=True)
class _Head:
    bench: str
    configuration: str
    driver: str
    step: float
    settings: Mapping[str, Value]
    pace: Pace
    bits: Mapping[str, str]


def _of_head(head: bytes, time: NDArray[np.float64], inputs: dict[str, NDArray[np.float64]], here: Location) -> Drive:
    try:
        data = read_json(head)
        if isinstance(data, dict) and data.get("version") != _VERSION:
            raise fail(f"is a drive of version {data.get('version')!r}; this dse reads {_VERSION}", here)
        told: _Head = read_noun(data, _Head, "head")
    except ValueError as error:
        raise fail(f"is not a drive: its header is damaged ({error})", here, "copy it again") from None
    names = told.bench, told.configuration, told.driver
    return Drive(*names, float(told.step), time, inputs, told.pace, told.settings, told.bits)


def _require(drive: Drive, path: Path) -> None:
    """Raise DseError unless *drive* is one."""
    here = Location(shown(path))
    for what, name in (("bench", drive.bench), ("configuration", drive.configuration)):
        if not _WORD.fullmatch(name):
            raise fail(f"is not a drive: {name[:LONGEST_NAME]!r} is not a name of a {what}", here)
    try:
        is_name = driver_name(drive.driver) == drive.driver
    except DseError:
        is_name = False
    if not is_name:
        raise fail(f"is not a drive: {drive.driver[:LONGEST_NAME]!r} is not a driver's name", here)
    strange = next((name for name in drive.inputs if not _PORT.fullmatch(name)), None)
    if strange is not None:
        raise fail(f"is not a drive: {strange[:LONGEST_NAME]!r} is not a port's name", here)
    n = len(drive.time)
    if n < 2 or not drive.inputs or any(len(column) != n for column in drive.inputs.values()):
        raise fail("is not a drive: it has no column or no step", here)
    if not (np.isfinite(drive.step) and drive.step > 0):
        raise fail("is not a drive: its step is not a time", here)
    for name, column in {_TIME: drive.time, **drive.inputs}.items():
        if not np.isfinite(column).all():
            raise fail(f"'{name}' is not a number in row {int(np.argmin(np.isfinite(column))) + 1}", here)
    if not np.allclose(drive.time, np.arange(n) * drive.step, rtol=0.0, atol=1e-6 * drive.step):
        raise fail(f"the times are not 0 and so on, {drive.step:g} s apart", here)
