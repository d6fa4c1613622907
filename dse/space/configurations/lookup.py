"""Objects by row: what each value of a variable stands for, gathered for whole blocks of rows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain
from operator import itemgetter
from typing import Generic, TypeVar

import numpy as np

from dse.space.flat import Rows

T = TypeVar("T")

Column = tuple[int | None, Sequence[T]]
"""A variable and one object for each of its values, and one for `ABSENT`; or None and the one object of every row."""

_AT_A_TIME = 1024


class Lookup(Generic[T]):
    """For each row one object per column, in the order of *columns*."""

    def __init__(self, columns: Sequence[Column[T]]) -> None:
        self.length = len(columns)
        self._objects = list(chain.from_iterable(entries for _, entries in columns))
        lengths = np.array([len(entries) for _, entries in columns], np.int64)
        self._starts = np.cumsum(lengths) - lengths
        self._lengths = lengths
        self._constant = np.array([variable is None for variable, _ in columns], np.bool_)
        self._variables = np.array([variable or 0 for variable, _ in columns], np.int64)

    def of(self, rows: Rows) -> Iterator[tuple[T, ...]]:
        """The objects of each row of a block, shape (rows, variables); read a few rows at a time."""
        if not self.length:
            yield from ((),) * len(rows)
            return
        for start in range(0, len(rows), _AT_A_TIME):
            places = self._places(rows[start : start + _AT_A_TIME])
            if self.length == 1:
                yield from ((self._objects[place],) for (place,) in places)
            else:
                # An itemgetter fills the tuple in one call.
                yield from (itemgetter(*numbers)(self._objects) for numbers in places)

    def _places(self, rows: Rows) -> list[list[int]]:
        values = np.zeros((len(rows), self.length), np.int64)
        values[:, ~self._constant] = rows[:, self._variables[~self._constant]]
        values += (values < 0) * self._lengths
        places: list[list[int]] = (values + self._starts).tolist()
        return places
