"""The Pareto set of a space over sums: every vector of objectives that no valid row improves on.

What is not dominated by the points found so far is a union of boxes below their local upper bounds. The best row
of a box under a positive combination of the objectives is a new point; a box without a row is done with (Klamroth,
Lacour and Vanderpooten, On the representation of the search region in multi-objective optimization, 2015).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dse.errors import fail
from dse.space.best import best, sums
from dse.space.diagram import Diagram, extremes
from dse.space.flat import Ints, Linear, Rows

MOST_POINTS = 2_000

_LARGEST = 1 << 58
"""What an objective may come to when it is put together with others."""

Weights = Mapping[int, Ints]
Point = tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Front:
    """The Pareto set, best of the first objective first: of each point its first row; shape (points, variables)."""

    rows: Rows
    values: tuple[Point, ...]


def pareto(
    diagram: Diagram,
    objectives: Sequence[Weights],
    largest: Sequence[bool] | None = None,
    most_points: int = MOST_POINTS,
) -> Front:
    """The complete Pareto set of the valid rows over sums of weights, least of each or *largest* where that is true.

    Raises DseError if there are more than *most_points*, and if the weights are too large for 64 bits.
    """
    signs = [-1 if most else 1 for most in largest or [False] * len(objectives)]
    aims = [{v: sign * w for v, w in weights.items()} for sign, weights in zip(signs, objectives, strict=True)]
    found: dict[Point, Rows] = {}
    if not diagram.empty and aims:
        ends = [tuple(int(side[0][0]) for side in extremes(diagram, aim)) for aim in aims]
        toward = _together(aims, [high - low for low, high in ends])
        boxes = [tuple(high + 1 for _, high in ends)]
        while boxes:
            # The largest first: deterministic, and its point splits most.
            box = boxes[-1]
            within = [Linear(aim, None, bound - 1) for aim, bound in zip(aims, box, strict=True)]
            ranking = best(diagram, toward, 1, within=within)
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
            boxes = _split(boxes, point)
    points = sorted(found)
    rows = np.array([found[point] for point in points], np.int16).reshape(len(points), len(diagram.order))
    values = tuple(tuple(sign * value for sign, value in zip(signs, point, strict=True)) for point in points)
    return Front(rows, values)


def _together(aims: Sequence[Weights], ranges: Sequence[int]) -> Weights:
    """The sum of all objectives, each times a positive whole number that makes their ranges alike."""
    widest = max(ranges)
    total: dict[int, Ints] = {}
    for aim, span in zip(aims, ranges, strict=True):
        room = _LARGEST // max(sum(int(np.abs(weights).max()) for weights in aim.values()), 1)
        factor = max(min(widest // span if span else 1, room), 1)
        for variable, weights in aim.items():
            total[variable] = total.get(variable, np.zeros_like(weights)) + factor * weights
    return total


def _split(boxes: Sequence[Point], point: Point) -> list[Point]:
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


def _below(point: Point, box: Point) -> bool:
    return all(value < bound for value, bound in zip(point, box, strict=True))
