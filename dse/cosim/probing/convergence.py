"""Whether outputs settle as something is made finer and finer, and how far that has to go for their error to show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

_SHRINKS = 0.6
"""Of the largest change, what the last one may be at most: a method of order 1 halves it each time."""


@dataclass(frozen=True, slots=True)
class Settling:
    """What came of making something finer several times; changes are averages over time, relative to the range.

    *at* is after how many times what is left is no more than what has changed; 0 if outputs do not change at all, or
    do not settle. *change* is what has changed until then, or at most; *last* the change from the last but one to the
    last; *place* after how many times the largest change came.
    """

    at: int = 0
    change: float = 0.0
    last: float = 0.0
    place: int = 0

    @property
    def reacts(self) -> bool:
        """Whether anything changed."""
        return self.change > 0.0

    @property
    def settles(self) -> bool:
        """Whether changes became small at last."""
        return self.at > 0


def settling_of(tables: Sequence[NDArray[np.float64]], *, least: float) -> Settling:
    """How *tables*, rows at the same times and a column for each output, go on from the first to the last.

    Changes of less than *least* of an output's range, or of a rounding error in each row, are none. Outputs that react
    have all to settle.
    """
    rows = min(map(len, tables))
    values = np.nan_to_num(np.stack([table[:rows] for table in tables]), posinf=0.0, neginf=0.0)
    size, reach = np.abs(values).max(axis=(0, 1), initial=0.0), np.ptp(values, axis=(0, 1))

    def apart(a: int, b: int) -> NDArray[np.float64]:
        distance = np.abs(values[a] - values[b]).mean(axis=0)
        distance[distance <= least * 1e-3 * size] = 0.0
        relative: NDArray[np.float64] = np.divide(distance, reach, out=np.zeros_like(distance), where=reach > 0.0)
        relative[relative < least] = 0.0
        return relative

    end = len(tables) - 1
    if end < 1:
        return Settling()
    done = np.array([apart(0, k) for k in range(end + 1)])
    left = np.array([apart(k, end) for k in range(end + 1)])
    steps = np.array([apart(k, k + 1) for k in range(end)])
    found = Settling(0, float(done.max(initial=0.0)), float(steps[-1].max(initial=0.0)))
    for column in np.flatnonzero(done.any(axis=0)):
        most = steps[:, column].max()
        enough = np.flatnonzero(left[1:end, column] <= 1.1 * done[1:end, column])
        if steps[-1, column] > _SHRINKS * most or not len(enough):
            return Settling(0, found.change, found.last, int(steps.max(axis=1).argmax()))
        found = Settling(max(found.at, int(enough[0]) + 1), found.change, found.last, found.place)
    return Settling(found.at, found.change, found.last, int(steps.max(axis=1).argmax()))


def moves(table: NDArray[np.float64]) -> bool:
    """Whether any output changes after the first step."""
    return bool(len(table) > 2 and (table[1:] != table[1]).any())


def grid_of(table: NDArray[np.float64], step: float) -> float:
    """How long outputs stand still from change to change, in rows *step* seconds apart; infinite without a grid."""
    changes = np.flatnonzero((np.diff(table, axis=0) != 0.0).any(axis=1))
    if len(changes) < 3 or len(changes) > 0.6 * (len(table) - 1):
        return inf
    gaps = np.diff(changes)
    gap = float(np.median(gaps))
    is_regular = np.mean(np.abs(gaps - gap) <= 1.0) >= 0.9  # what changes when something happens has no grid
    return gap * step if gap >= 2.0 and is_regular else inf
