"""The designs that no other is better than, and how much of the objectives' space they cover."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

Values = Sequence[float]
"""Objectives, to be minimised."""


def front(objectives: Sequence[Values], violations: Sequence[float]) -> tuple[int, ...]:
    """The numbers of the designs without a violation that no other dominates, in order; of equal ones the first."""
    kept: dict[tuple[float, ...], int] = {}
    for number, (values, violation) in enumerate(zip(objectives, violations, strict=True)):
        one = tuple(values)
        if violation > 0 or any(_is_as_good(other, one) for other in kept):
            continue
        kept = {other: place for other, place in kept.items() if not _is_as_good(one, other)}
        kept[one] = number
    return tuple(kept.values())


def hypervolume(points: Sequence[Values], reference: Values) -> float:
    """The volume that *points* dominate up to the *reference* point (Zitzler and Thiele 1998); exact.

    By slices along the last objective: the time grows with a power of the number of objectives.
    """
    inside = [tuple(point) for point in points if all(value < end for value, end in zip(point, reference, strict=True))]
    return _volume([inside[number] for number in front(inside, [0.0] * len(inside))], tuple(reference))


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


def _volume(points: Sequence[tuple[float, ...]], reference: tuple[float, ...]) -> float:
    if not points:
        return 0.0
    if len(reference) == 1:
        return reference[0] - min(point[0] for point in points)
    total = 0.0
    ordered = sorted(points, key=lambda point: point[-1])
    for place, point in enumerate(ordered):
        end = ordered[place + 1][-1] if place + 1 < len(ordered) else reference[-1]
        if end > point[-1]:
            below = [other[:-1] for other in ordered[: place + 1]]
            flat = [below[number] for number in front(below, [0.0] * len(below))]
            total += (end - point[-1]) * _volume(flat, reference[:-1])
    return total


def _is_as_good(one: Values, other: Values) -> bool:
    return all(a <= b for a, b in zip(one, other, strict=True))
