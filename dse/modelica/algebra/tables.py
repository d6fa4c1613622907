"""Tables over one and two axes and their derivatives, as the C runtime computes them.

Smooth 1-D: monotone cubic Hermite (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5(2), 1984, 300-304). Smooth 2-D:
cubic Hermite in x over cubic Hermite in y with three-point parabolic slopes, linear in the values. Two points: linear.
Outside: 1 holds the end value, 2 continues the slope at the end, 3 is an error (NaN here).
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable, Sequence
from itertools import pairwise

HOLD, LINEAR, ERROR = 1, 2, 3


def table1(
    order: int, x: float, xs: Sequence[float], ys: Sequence[float], is_smooth: bool, extrapolation: int
) -> float:
    """Value or derivative (*order* 1, 2) at *x* of the table of *ys* over strictly increasing *xs*, at least two."""
    slopes = _monotone_slopes(xs, ys) if is_smooth and len(xs) > 2 else None
    return _curve(order, x, xs, ys, slopes, extrapolation)


def table2(
    orders: tuple[int, int],
    point: tuple[float, float],
    axes: tuple[Sequence[float], Sequence[float]],
    zs: Sequence[float],
    is_smooth: bool,
    extrapolation: int,
) -> float:
    """Value or partial derivative at *point* of *zs*, row by row: ``zs[i * len(ys) + j]`` stands at (xs[i], ys[j])."""
    xs, ys = axes
    by_x = _weights(orders[0], point[0], xs, is_smooth, extrapolation)
    by_y = _weights(orders[1], point[1], ys, is_smooth, extrapolation)
    rows = [math.fsum(w * zs[i * len(ys) + j] for j, w in enumerate(by_y)) for i in range(len(xs))]
    return math.fsum(w * row for w, row in zip(by_x, rows, strict=True))


def _extended(inside: Callable[[int, float], float], order: int, x: float, xs: Sequence[float], outside: int) -> float:
    if xs[0] <= x <= xs[-1]:
        return inside(order, x)
    if math.isnan(x) or outside == ERROR:
        return math.nan
    end = xs[0] if x < xs[0] else xs[-1]
    if outside == HOLD:
        return inside(0, end) if order == 0 else 0.0
    if order == 0:
        return inside(0, end) + inside(1, end) * (x - end)
    return inside(1, end) if order == 1 else 0.0


def _weights(order: int, x: float, xs: Sequence[float], is_smooth: bool, extrapolation: int) -> list[float]:
    """How much each point's value counts: a table with parabolic slopes is linear in its values."""
    found = [0.0] * len(xs)
    for place in range(len(xs)):
        unit = [float(k == place) for k in range(len(xs))]
        slopes = _parabolic_slopes(xs, unit) if is_smooth and len(xs) > 2 else None
        found[place] = _curve(order, x, xs, unit, slopes, extrapolation)
    return found


def _curve(
    order: int, x: float, xs: Sequence[float], ys: Sequence[float], slopes: Sequence[float] | None, extrapolation: int
) -> float:
    """Through the points with the given slopes, or in straight lines without."""

    def inside(order: int, x: float) -> float:
        place = _interval(x, xs)
        width = xs[place + 1] - xs[place]
        if slopes is None:
            left, right = _chord(order, (x - xs[place]) / width, width)
            return left * ys[place] + right * ys[place + 1]
        basis = _hermite(order, (x - xs[place]) / width, width)
        ends = (ys[place], ys[place + 1], slopes[place], slopes[place + 1])
        return math.fsum(a * b for a, b in zip(basis, ends, strict=True))

    return _extended(inside, order, x, xs, extrapolation)


def _interval(x: float, xs: Sequence[float]) -> int:
    return min(max(bisect.bisect_right(xs, x) - 1, 0), len(xs) - 2)


def _chord(order: int, s: float, width: float) -> tuple[float, float]:
    if order == 0:
        return 1 - s, s
    return (-1 / width, 1 / width) if order == 1 else (0.0, 0.0)


def _hermite(order: int, s: float, width: float) -> tuple[float, float, float, float]:
    """Weights of the left and right value and the left and right slope."""
    if order == 0:
        return (1 + 2 * s) * (1 - s) ** 2, s * s * (3 - 2 * s), width * s * (1 - s) ** 2, width * s * s * (s - 1)
    if order == 1:
        return 6 * s * (s - 1) / width, 6 * s * (1 - s) / width, (1 - s) * (1 - 3 * s), s * (3 * s - 2)
    return (12 * s - 6) / width**2, (6 - 12 * s) / width**2, (6 * s - 4) / width, (6 * s - 2) / width


def _monotone_slopes(xs: Sequence[float], ys: Sequence[float]) -> list[float]:
    widths = [b - a for a, b in pairwise(xs)]
    chords = [(b - a) / w for (a, b), w in zip(pairwise(ys), widths, strict=True)]
    inner = []
    for k in range(1, len(xs) - 1):
        left, right = chords[k - 1], chords[k]
        if left * right <= 0:
            inner.append(0.0)
            continue
        by_left, by_right = 2 * widths[k] + widths[k - 1], widths[k] + 2 * widths[k - 1]
        inner.append((by_left + by_right) / (by_left / left + by_right / right))
    first = _monotone_end(widths[0], widths[1], chords[0], chords[1])
    last = _monotone_end(widths[-1], widths[-2], chords[-1], chords[-2])
    return [first, *inner, last]


def _monotone_end(width: float, next_width: float, chord: float, next_chord: float) -> float:
    slope = ((2 * width + next_width) * chord - width * next_chord) / (width + next_width)
    if slope * chord <= 0:
        return 0.0
    if chord * next_chord < 0 and abs(slope) > 3 * abs(chord):
        return 3 * chord
    return slope


def _parabolic_slopes(xs: Sequence[float], ys: Sequence[float]) -> list[float]:
    widths = [b - a for a, b in pairwise(xs)]
    chords = [(b - a) / w for (a, b), w in zip(pairwise(ys), widths, strict=True)]
    inner = [
        (widths[k - 1] * chords[k] + widths[k] * chords[k - 1]) / (widths[k - 1] + widths[k])
        for k in range(1, len(xs) - 1)
    ]
    first = ((2 * widths[0] + widths[1]) * chords[0] - widths[0] * chords[1]) / (widths[0] + widths[1])
    last = ((2 * widths[-1] + widths[-2]) * chords[-1] - widths[-1] * chords[-2]) / (widths[-1] + widths[-2])
    return [first, *inner, last]
