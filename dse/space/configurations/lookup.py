"""Objects by row: what each value of a variable stands for, gathered for whole blocks of rows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Generic, TypeVar

import numpy as np

from dse.space.flat import Rows

_T = TypeVar("_T")

LookupColumn = tuple[int | None, Sequence[_T]]
"""A variable and one object for each of its values, and one for `ABSENT`; or None and the one object of every row."""

_AT_A_TIME = 1024


class Lookup(Generic[_T]):
    """For each row one object per column, in the order of *columns*."""

    def __init__(self, columns: Sequence[LookupColumn[_T]]) -> None:
        objects = [thing for _, entries in columns for thing in entries]
        self._objects = np.fromiter(objects, object, len(objects))
        self._lengths = np.array([len(entries) for _, entries in columns], np.int64)
        self._starts = np.cumsum(self._lengths) - self._lengths
        self._constant = np.array([variable is None for variable, _ in columns], np.bool_)
        self._variables = np.array([variable or 0 for variable, _ in columns], np.int64)

    def of(self, rows: Rows) -> Iterator[list[_T]]:
        """The objects of each row of a block, shape (rows, variables); read a few rows at a time."""
        for start in range(0, len(rows), _AT_A_TIME):
            block = rows[start : start + _AT_A_TIME]
            values = np.zeros((len(block), len(self._lengths)), np.int64)
            values[:, ~self._constant] = block[:, self._variables[~self._constant]]
            values += (values < 0) * self._lengths
            yield from self._objects[values + self._starts].tolist()
