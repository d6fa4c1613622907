"""How much of the objectives' space a front covers, and where its knee is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dse.exploration.designs import front_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

Values = Sequence[float]
"""Objectives, to be minimised."""


def hypervolume(points: Sequence[Values], reference: Values) -> float:
    """The volume that *points* dominate up to the *reference* point (Zitzler and Thiele 1998); exact.

    By slices along the last objective: the time grows with a power of the number of objectives.
    """
    values = np.array(points, dtype=np.float64).reshape(len(points), len(reference))
    return _volume(values[(values < np.array(reference)).all(axis=1)], tuple(reference))


def knee(points: Sequence[Values]) -> int | None:
    """The point of a front farthest from the line, or plane, through the ends of its objectives (Das 1999).

    In the direction of improvement, the objectives in units of their ranges; None if the front has less than three.
    """
    if len(points) < 3:
        return None
    values = np.array(points, dtype=np.float64)
    width = values.max(axis=0) - values.min(axis=0)
    unit = (values - values.min(axis=0)) / np.where(width > 0, width, 1.0)
    return int(np.argmin(np.round(unit.sum(axis=1), 12)))


def _volume(points: Array, reference: Values) -> float:
    if not len(points):
        return 0.0
    if len(reference) == 1:
        return float(reference[0] - points.min())
    front = points[front_of(points)]
    front = front[np.argsort(front[:, -1], kind="stable")]
    depths = np.diff(front[:, -1], append=reference[-1]).tolist()
    return math.fsum(d * _volume(front[: n + 1, :-1], reference[:-1]) for n, d in enumerate(depths) if d > 0)
