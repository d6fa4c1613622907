"""The Pareto set of a space over sums: every vector of objectives that no valid row improves on.

What is not dominated by the points found so far is a union of boxes below their local upper bounds. The best row
of a box under a positive combination of the objectives is a new point; a box without a row is done with (Klamroth,
Lacour and Vanderpooten, On the representation of the search region in multi-objective optimization, 2015).

Example: rows of cost and mass (1, 5), (3, 3), (4, 4) and (5, 1).

    the least cost + mass of all is 6, at (3, 3): what is left has cost < 3 or mass < 3
    cost < 3: (1, 5). mass < 3: (5, 1). The boxes that are left have no row, so these three points are the set

Cost: one exact optimum for each point and for each box that turns out empty, so it grows with the size of the set; at
most 2,000 points and about a minute.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from dse.errors import fail
from dse.space.flat import Rows
from dse.space.methods.optimum.optimizer import RankedRows, SumWeights, sums

MOST_PARETO_POINTS = 2_000

MOST_PARETO_ROUNDS = 10_000
"""About a minute."""

_LARGEST = 1 << 58
"""What an objective may come to when it is put together with others."""

ParetoPoint = tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ParetoFront:
    """The Pareto set, best of the first objective first: of each point one row; shape (points, variables)."""

    rows: Rows
    values: tuple[ParetoPoint, ...]


class BoxOptimizer(Protocol):
    """Finds the best rows under combinations of *objectives*, within bounds on them."""

    @property
    def objectives(self) -> Sequence[SumWeights]:
        """The sums to be made least."""

    def ends(self, objective: int) -> tuple[int, int]:
        """What an objective is surely not below, and not above; there must be a row."""

    def best(self, factors: Sequence[int], number: int, highs: Sequence[int | None] | None = None) -> RankedRows:
        """The *number* rows of least *factors* times the objectives, each of which is at most its *highs*."""


def pareto(
    make: Callable[[Sequence[SumWeights]], BoxOptimizer],
    objectives: Sequence[SumWeights],
    largest: Sequence[bool] | None = None,
    most_points: int = MOST_PARETO_POINTS,
) -> ParetoFront:
    """The complete Pareto set of the valid rows over sums of weights, least of each or *largest* where that is true.

    *make* makes the optimizer of sums. Raises what that raises, and DseError if there are more than *most_points*.
    """
    signs = [-1 if most else 1 for most in largest or [False] * len(objectives)]
    aims = [{v: sign * w for v, w in weights.items()} for sign, weights in zip(signs, objectives, strict=True)]
    found: dict[ParetoPoint, Rows] = {}
    optimizer = make(aims)
    # Boxes that begin below what can be reached at all are the hardest to search, and need no search.
    alone = [optimizer.best([int(n == other) for other in range(len(aims))], 1).values for n in range(len(aims))]
    if aims and all(alone):
        ideal = [int(values[0]) for values in alone]
        ends = [optimizer.ends(number) for number in range(len(aims))]
        factors = _alike(aims, [high - low for low, high in ends])
        boxes = [tuple(high + 1 for _, high in ends)]
        while boxes:
            # The largest first: deterministic, and its point splits most.
            box = boxes[-1]
            ranking = optimizer.best(factors, 1, [bound - 1 for bound in box])
            if not len(ranking.rows):
                boxes.remove(box)
                continue
            point = tuple(int(sums(aim, ranking.rows)[0]) for aim in aims)
            if len(found) == most_points:
                raise fail(
                    f"more than {most_points} configurations are Pareto-optimal",
                    hint="fewer objectives, coarser properties or tighter constraints make fewer",
                )
            found[point] = ranking.rows[0]
            boxes = [box for box in _split(boxes, point) if _below(ideal, box)]
    points = sorted(found)
    rows = np.array([found[point] for point in points], np.int16)
    values = tuple(tuple(sign * value for sign, value in zip(signs, point, strict=True)) for point in points)
    return ParetoFront(rows, values)


def _alike(aims: Sequence[SumWeights], ranges: Sequence[int]) -> list[int]:
    """Positive whole factors that make the ranges of the objectives alike."""
    widest = max(ranges)
    factors = []
    for aim, span in zip(aims, ranges, strict=True):
        room = _LARGEST // max(sum(int(np.abs(weights).max()) for weights in aim.values()), 1)
        factors.append(max(min(widest // span if span else 1, room // len(aims)), 1))
    return factors


def _split(boxes: Sequence[ParetoPoint], point: ParetoPoint) -> list[ParetoPoint]:
    """Upper corners of the boxes that are left when what *point* dominates is taken away, ascending."""
    left = {box for box in boxes if not _below(point, box)}
    cut = {
        (*box[:axis], value, *box[axis + 1 :])
        for box in boxes
        if _below(point, box)
        for axis, value in enumerate(point)
    }
    every = left | cut
    return sorted(
        box
        for box in every
        if box not in cut
        or not any(other != box and all(a <= b for a, b in zip(box, other, strict=True)) for other in every)
    )


def _below(point: Sequence[int], box: ParetoPoint) -> bool:
    return all(value < bound for value, bound in zip(point, box, strict=True))
