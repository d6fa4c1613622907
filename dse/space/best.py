"""The best rows under an objective: exact, complete, and the same ones every time.

Of rows of equal value those come first that the list has first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import inf, nextafter
from typing import Protocol

import numpy as np

from dse.space.bounds import cuts_of
from dse.space.diagram import Diagram
from dse.space.flat import Bools, Floats, Fold, Ints, Linear, Rows, Wide
from dse.space.folds import fold_rows
from dse.space.listing import Listing
from dse.space.optimizer import Optimizer, Ranking, sums
from dse.space.walk import Rounds

__all__ = ["Ranking", "Valued", "best", "best_valued", "sums"]


class Valued(Protocol):
    """A nonlinear objective over folds."""

    @property
    def folds(self) -> tuple[Fold, ...]:
        """What it is calculated from."""

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Floats, Floats]:
        """Ends between which the value lies for folds in [low, high], as in `Judge`; infinite where unknown."""

    def value(self, folds: Sequence[int]) -> Fraction | None:
        """The exact value; None where it is undefined, and such rows are not ranked."""


def best(
    diagram: Diagram,
    weights: Mapping[int, Ints],
    number: int,
    *,
    largest: bool = False,
    within: Sequence[Linear] = (),
    rounds: Rounds | None = None,
) -> Ranking:
    """The *number* valid rows of least (or largest) sum of weights[variable][value], or all if there are fewer.

    Weights are as in `Linear`. Only rows that meet the sums of *within*, too, count. Raises DseError if weights are
    too large for whole numbers of 64 bits, TooMuchError when *rounds* are spent.
    """
    sign = -1 if largest else 1
    beside = cuts_of(within)
    aim = {variable: sign * values for variable, values in weights.items()}
    optimizer = Optimizer(diagram, [aim, *(cut.weights for cut in beside)])
    found = optimizer.best([1, *[0] * len(beside)], number, [None, *(cut.high for cut in beside)], rounds)
    return Ranking(found.rows, tuple(sign * int(value) for value in found.values))


def best_valued(
    diagram: Diagram, objective: Valued, number: int, *, largest: bool = False, most_rounds: int | None = None
) -> Ranking:
    """The *number* valid rows of least (or largest) defined value, or all if there are fewer.

    A branch and bound over the list, with the ends of the objective as bounds. Raises TooMuchError after
    *most_rounds* of `Walk`: the best of very large spaces cannot be proven this way.
    """
    rounds = None if most_rounds is None else Rounds(most_rounds)
    judge = _Better(objective, largest)
    rows = np.zeros((0, len(diagram.order)), np.int16)
    values: list[Fraction] = []
    if number < 1:
        return Ranking(rows, ())
    for block in Listing(diagram, wides=[Wide(objective.folds, judge)], rounds=rounds):
        found = [judge.value(folds) for folds in _folds_of(objective, block)]
        ranked = [value for value in found if value is not None]
        rows = np.concatenate((rows, block[[value is not None for value in found]]))
        values += ranked
        order = sorted(range(len(values)), key=values.__getitem__)[:number]
        rows, values = rows[order], [values[place] for place in order]
        if len(values) == number:
            judge.limit = values[-1]
    return Ranking(rows, tuple(-value if largest else value for value in values))


class _Better:
    """Holds for rows whose value, negated if the largest is wanted, is below *limit*; it turns stricter on the way."""

    def __init__(self, objective: Valued, largest: bool) -> None:
        self.objective = objective
        self.largest = largest
        self.limit: Fraction | None = None

    def value(self, folds: Sequence[int]) -> Fraction | None:
        value = self.objective.value(folds)
        return -value if value is not None and self.largest else value

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Bools, Bools]:
        ends = self.objective.bounds(low, high)
        least_value = -ends[1] if self.largest else ends[0]
        everything = np.ones(len(least_value), np.bool_)
        if self.limit is None:
            return everything, everything
        return ~(least_value > nextafter(float(self.limit), inf)), everything

    def holds(self, folds: Sequence[int]) -> bool:
        value = self.value(folds)
        return value is not None and (self.limit is None or value < self.limit)


def _folds_of(objective: Valued, rows: Rows) -> list[tuple[int, ...]]:
    columns = [fold_rows(fold, rows).tolist() for fold in objective.folds]
    return list(zip(*columns, strict=True))
