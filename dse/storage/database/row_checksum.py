"""A number that says whether rows are still what was written: a changed bit in a cell changes it for certain."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from types import NoneType
from typing import Any

import numpy as np
from numpy.typing import NDArray

_ODD = 0x9E3779B97F4A7C15


Cells = Sequence[Any] | NDArray[np.float64]
"""A column as it stands in the database; an array where there are only numbers."""


def cells_of(column: Sequence[Any]) -> Cells:
    """*column* as an array if it holds float and None (NaN) alone."""
    return np.array(column, dtype=np.float64) if set(map(type, column)) <= {float, NoneType} else column


def row_checksums(columns: Sequence[Cells]) -> NDArray[np.int64]:
    """The checksum of each row of *columns*, (n,): a sum over its cells, each times an odd number of its column's.

    NaN and None are alike, and zeros of both signs, as SQLite does not tell them apart.
    """
    total = np.zeros(len(columns[0]), dtype=np.uint64)
    for place, column in enumerate(columns):
        total += _bits(column) * np.uint64((2 * place + 1) * _ODD % 2**64)
    return total.view(np.int64)


def stored_checksum(number: int, file: str | None) -> int:
    """The checksum of a row that says that the waveforms of run *number* are in *file*."""
    return int(row_checksums([(number,), (file or "",)])[0])


def _bits(column: Cells) -> NDArray[np.uint64]:
    if isinstance(column, np.ndarray):
        numbers = column + 0.0
        numbers[np.isnan(numbers)] = np.nan
        return numbers.view(np.uint64)
    kinds = set(map(type, column))
    if kinds <= {float, NoneType}:
        return _bits(cells_of(column))
    if kinds == {str}:
        known = {text: zlib.crc32(text.encode("utf-8", "surrogatepass")) for text in set(column)}
        return np.array([known[text] for text in column], dtype=np.uint64)
    if kinds == {int}:
        return np.array(column, dtype=np.int64).view(np.uint64)
    if len(kinds) > 1:
        return np.array([_bits((cell,))[0] for cell in column], dtype=np.uint64)
    return np.zeros(len(column), dtype=np.uint64)  # nothing that is ever stored
