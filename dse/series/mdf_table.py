"""Channels of measurements in ASAM MDF, versions 3 and 4, by `asammdf`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.time_series import Series
from dse.errors import DseError, Location, closest, fail
from dse.formats import shown
from dse.series.columns import RawColumn, split_unit

_ALGEBRAIC = {"3": (10,), "4": (3,)}
"""Conversions by a formula in the file, by the first figure of MDF's version."""


def read_channel(series: Series) -> tuple[RawColumn, RawColumn]:
    """The times, in seconds, and the samples of a channel. Raises DseError; also if asammdf is not installed."""
    path, where = series.file.path, series.where
    try:
        from asammdf import MDF
    except ImportError:
        hint = "python -m pip install 'dse-workbench[mdf]'"
        raise fail(f"{shown(path)}: reading MDF needs the package asammdf", where, hint) from None
    if series.time:
        raise fail("channels of MDF have their own times", where, "leave out 'time'")
    if isinstance(series.column, int):
        raise fail("channels of MDF go by their names", where)
    try:
        with path.open("rb") as stream, MDF(stream) as mdf:
            name, stated, group, index = _found(mdf, series.column, series.file.group, where)
            signal = mdf.get(name, group=group, index=index, raw=True)
            if signal.conversion is not None and signal.conversion.conversion_type in _ALGEBRAIC[str(mdf.version)[0]]:
                # asammdf would have it evaluated as Python.
                what = f"the channel '{name}' is converted by a formula in the file, which is not evaluated"
                raise fail(what, where, "export it as CSV or Parquet")
            signal = signal.physical()
    except DseError:
        raise
    except Exception as error:  # noqa: BLE001  # what it raises of damaged files is not told
        raise fail(f"{shown(path)} cannot be read: {error}", where, "is it an MDF file?") from None

    def at(row: int) -> Location:
        return Location(f"{shown(path)}, sample {row + 1} of {name}")

    invalid = signal.invalidation_bits
    cells = _cells(signal.samples, name, where)
    if invalid is not None and np.any(invalid):
        cells[np.asarray(invalid, dtype=bool)] = np.nan if cells.dtype != object else ""
    times = np.array(signal.timestamps, dtype=np.float64)
    return RawColumn("time", "", "s", times, at), RawColumn(name, stated, (signal.unit or "").strip(), cells, at)


def _found(mdf: Any, wanted: str, group: int | None, where: Location) -> tuple[str, str, int, int]:
    """Name, unit stated, group and index of the channel *wanted*."""
    for name, stated in ((wanted, ""), split_unit(wanted)):
        if name in mdf:
            places = [place for place in mdf.whereis(name) if group in (None, place[0])]
            if not places:
                raise fail(f"the group {group} has no channel '{name}'", where)
            if len(places) > 1:
                groups = ", ".join(str(number) for number in sorted({place[0] for place in places}))
                hint = "set 'group: …'" if "," in groups else "export it as CSV or Parquet, under another name"
                raise fail(f"several channels are called '{name}', in the groups {groups}", where, hint)
            return name, stated, *places[0]
    raise fail(f"there is no channel '{wanted}'", where, closest(wanted, mdf.channels_db))


def _cells(samples: NDArray[Any], name: str, where: Location) -> NDArray[Any]:
    if samples.ndim != 1 or samples.dtype.names:
        raise fail(f"the channel '{name}' has arrays or structures as samples", where, "name a channel of numbers")
    if samples.dtype.kind in "biuf":
        return samples.astype(np.float64)
    texts = [text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text) for text in samples.tolist()]
    return np.array([text.rstrip("\0").strip() for text in texts], dtype=object)
