"""Where two halves meet: pairs of a way before and a way after whose sums together are within bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import prod

import numpy as np

from dse.space.methods.grid.axes import SumAxis, SumSpan
from dse.space.methods.grid.digits import Digits, running_sums, scalar_product


@dataclass(frozen=True, slots=True)
class Side:
    """What the places of a grid stand for: the span of each axis."""

    spans: tuple[SumSpan, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Of a grid without padding."""
        return tuple(span.length for span in self.spans)


def summed(grid: Digits, side: Side, paths: int) -> Digits:
    """Ways to no more than each sum, along every axis; *paths* bounds their total."""
    return running_sums(tuple(digit.reshape(side.shape) for digit in grid), paths)


def pairs(sums: Sequence[SumAxis], own: Digits, side: Side, others: Digits, other: Side) -> int:
    """Ways of *own* times ways of *others* whose sums, added up, are within the bounds of every axis.

    *others* as `summed` makes them.
    """
    grids = [digit.reshape(side.shape) for digit in own]
    corners = [[(1, axis.high)] if axis.low is None else [(1, axis.high), (-1, axis.low - 1)] for axis in sums]
    total = 0
    for corner in product(*corners):
        kept, places = [], []
        for (_, bound), span, opposite in zip(corner, side.spans, other.spans, strict=True):
            place = bound - span.low - np.arange(span.length) - opposite.low
            kept.append(slice(0, int((place >= 0).sum())))
            places.append(np.minimum(place[place >= 0], opposite.length - 1))
        ours = tuple(digit[tuple(kept)] for digit in grids)
        total += prod(sign for sign, _ in corner) * scalar_product(
            ours, tuple(digit[np.ix_(*places)] for digit in others)
        )
    return total
