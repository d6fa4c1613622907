"""The best rows under an objective: exact, complete, and the same ones every time.

Of rows of equal value those come first that the list has first. A linear objective becomes one more cut, with a
bound that starts at what no row can beat and is let out until enough rows are within; inside a walk it follows the
last row that is good enough. Together with the other cuts it makes surrogates, which is the Lagrangian bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, nextafter
from typing import Protocol

import numpy as np

from dse.errors import fail
from dse.space.bounds import Cut, cuts_of, divisor, fits, least, opposite, overall, tightest
from dse.space.diagram import Diagram
from dse.space.flat import Bools, Floats, Fold, Ints, Linear, Rows, Wide
from dse.space.folds import fold_rows
from dse.space.listing import Listing

_STEPS = 512
"""The first bound tried lets in one part in so many of what the objective can range over;"""

_WIDER = 4
"""the next so many times as much."""


@dataclass(frozen=True, slots=True, eq=False)
class Ranking:
    """Rows, shape (rows, variables), best first, and the objective of each; whole numbers if it is linear."""

    rows: Rows
    values: tuple[int, ...] | tuple[Fraction, ...]


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
) -> Ranking:
    """The *number* valid rows of least (or largest) sum of weights[variable][value], or all if there are fewer.

    Weights are as in `Linear`. Only rows that meet the sums of *within*, too, count. Raises DseError if weights are
    too large for whole numbers of 64 bits.
    """
    if not all(map(fits, (Linear(weights, None, None), *within))):
        raise fail("the numbers of the objective have too many digits", hint="round the properties it is made of")
    unit = divisor(weights) * (-1 if largest else 1)
    aim = {variable: values // unit for variable, values in weights.items()}
    if diagram.empty or number < 1:
        return Ranking(np.zeros((0, len(diagram.order)), np.int16), ())
    bottom, top = _range(diagram, aim)
    beside = cuts_of(within)
    low = _least_possible(diagram, aim, beside, bottom, top)
    bound = min(low + max((top - bottom) // _STEPS, 1), top)
    rows, values = _nothing(diagram)
    while True:
        found, reached, complete = _within(diagram, [Cut(aim, bound), *beside], number, low)
        if not complete:
            # Enough are this good. Of those that are better, and may be left out here, all are found again.
            last = reached == reached[-1]
            rows, values, bound = found[last], reached[last], int(reached[-1]) - 1
            continue
        rows, values = np.concatenate((found, rows))[:number], np.concatenate((reached, values))[:number]
        if len(rows) == number or bound == top:
            return Ranking(rows, tuple(unit * value for value in values.tolist()))
        rows, values = _nothing(diagram)
        bound = min(low + _WIDER * (bound - low), top)


def best_valued(
    diagram: Diagram, objective: Valued, number: int, *, largest: bool = False, most_rounds: int | None = None
) -> Ranking:
    """The *number* valid rows of least (or largest) defined value, or all if there are fewer.

    A branch and bound over the list, with the ends of the objective as bounds. Raises TooMuchError after
    *most_rounds* of `Walk`: the best of very large spaces cannot be proven this way.
    """
    judge = _Better(objective, largest)
    rows = np.zeros((0, len(diagram.order)), np.int16)
    values: list[Fraction] = []
    if number < 1:
        return Ranking(rows, ())
    for block in Listing(diagram, wides=[Wide(objective.folds, judge)], most_rounds=most_rounds):
        found = [judge.value(folds) for folds in _folds_of(objective, block)]
        ranked = [value for value in found if value is not None]
        rows = np.concatenate((rows, block[[value is not None for value in found]]))
        values += ranked
        order = sorted(range(len(values)), key=values.__getitem__)[:number]
        rows, values = rows[order], [values[place] for place in order]
        if len(values) == number:
            judge.limit = values[-1]
    return Ranking(rows, tuple(-value if largest else value for value in values))


def sums(weights: Mapping[int, Ints], rows: Rows) -> Ints:
    """The sum of weights[variable][value] of each row, shape (rows,)."""
    total = np.zeros(len(rows), np.int64)
    for variable, values in weights.items():
        total += values[rows[:, variable]]
    return total


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


def _within(diagram: Diagram, cuts: Sequence[Cut], number: int, low: int) -> tuple[Rows, Ints, bool]:
    """Of the rows within the cuts the *number* of least sum of the first, by sum and then in the order of the list.

    No valid row is below *low*. The last is false if *number* rows were found so much better than the bound that a
    walk with another bound should go on from there.
    """
    listing = Listing(diagram, cuts, movable=1)
    rows, values = _nothing(diagram)
    aim, bound = cuts[0].weights, cuts[0].high
    for block in listing:
        reached = sums(aim, block)
        # What was listed before the bound was lowered last may be beyond it.
        good = reached <= bound
        rows, values = np.concatenate((rows, block[good])), np.concatenate((values, reached[good]))
        order = np.argsort(values, kind="stable")[:number]
        rows, values = rows[order], values[order]
        if len(values) < number or values[-1] > bound:
            continue
        if values[-1] <= low:
            break
        if 2 * (int(values[-1]) - low) < cuts[0].high - low:
            return rows, values, False
        listing.walk.tighten(0, bound - int(values[-1]) + 1)
        bound = int(values[-1]) - 1
    return rows, values, True


def _nothing(diagram: Diagram) -> tuple[Rows, Ints]:
    return np.zeros((0, len(diagram.order)), np.int16), np.zeros(0, np.int64)


def _range(diagram: Diagram, weights: Mapping[int, Ints]) -> tuple[int, int]:
    """Least and greatest sum of any path."""
    ends = least(diagram, [weights, {variable: -values for variable, values in weights.items()}])[0][:, 0]
    return int(ends[0]), -int(ends[1])


def _least_possible(diagram: Diagram, weights: Mapping[int, Ints], beside: Sequence[Cut], bottom: int, top: int) -> int:
    """A value that no valid row can be below: the bound at which the combination of all cuts is in reach."""
    others = list(beside)
    if not diagram.expanded:
        others += cuts_of([linear for linear in diagram.flat.linears() if fits(linear)])
    others = tightest(others)
    if not others:
        return bottom
    # A bound on the objective itself, from the other side.
    refuted = max([bottom, *(-cut.high for cut in others if opposite(cut.weights, weights))]) - 1
    possible = max(top, refuted + 1)
    while possible - refuted > max((top - bottom) // _STEPS, 1):
        middle = (refuted + possible) // 2
        cuts = overall(diagram.flat, [Cut(weights, middle), *others])
        reached = least(diagram, [cut.weights for cut in cuts])[0][:, 0]
        if any(int(low) > cut.high for low, cut in zip(reached, cuts, strict=True)):
            refuted = middle
        else:
            possible = middle
    return refuted + 1


def _folds_of(objective: Valued, rows: Rows) -> list[tuple[int, ...]]:
    columns = [fold_rows(fold, rows).tolist() for fold in objective.folds]
    return list(zip(*columns, strict=True))
