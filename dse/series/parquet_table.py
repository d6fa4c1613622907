"""Columns of Parquet files, with the units their fields state."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.errors import Location, fail
from dse.formats import shown
from dse.series.columns import Place, RawColumn, split_unit


def read_parquet(path: Path, places: Callable[[Sequence[str]], Sequence[Place]], where: Location) -> list[RawColumn]:
    """The columns that *places* takes of the headings. A field's unit is its metadata ``unit``. Raises DseError."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        with path.open("rb") as stream, pq.ParquetFile(stream, pre_buffer=False) as parquet:
            schema = parquet.schema_arrow
            found = places(schema.names)
            # By place, as two columns may have one name.
            columns = {place.index: _column(parquet, place.index) for place in found}
    except (OSError, pa.ArrowException) as error:
        raise fail(f"{shown(path)} cannot be read: {error}", where, "is it a Parquet file?") from None
    return [
        RawColumn(
            field.name,
            place.stated,
            ((field.metadata or {}).get(b"unit", b"")).decode("utf-8", "replace") or split_unit(field.name)[1],
            _cells(field.name, columns[place.index], where),
            lambda row: Location(f"{shown(path)}, row {row + 1}"),
        )
        for place in found
        for field in (schema.field(place.index),)
    ]


def _column(parquet: Any, index: int) -> Any:
    name = parquet.schema_arrow.names[index]
    # No threads of Arrow's: one that lets go of a buffer of Python's while Python ends aborts the process.
    table = parquet.read(columns=[name], use_threads=False)
    return table.column(list(parquet.schema_arrow.names[: index + 1]).count(name) - 1)


def _cells(name: str, column: Any, where: Location) -> NDArray[Any]:
    import pyarrow as pa

    kind = column.type.value_type if pa.types.is_dictionary(column.type) else column.type
    if pa.types.is_timestamp(kind) or pa.types.is_date(kind):
        return np.array(column.cast(pa.timestamp("ns")).to_numpy(), dtype="datetime64[ns]")
    if (
        pa.types.is_boolean(kind)
        or pa.types.is_integer(kind)
        or pa.types.is_floating(kind)
        or pa.types.is_decimal(kind)
    ):
        return np.array(column.cast(pa.float64()).to_numpy(), dtype=np.float64)
    if pa.types.is_string(kind) or pa.types.is_large_string(kind):
        return np.array(["" if text is None else text.strip() for text in column.to_pylist()], dtype=object)
    raise fail(f"the column '{name}' holds {kind}, neither numbers nor texts nor times", where)
