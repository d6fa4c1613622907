"""Newton's method in plain Python: the same operations in the same order as in newton.h, and so the same bits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf, isfinite
from struct import pack

SOLVED = 1e-12
NEARLY_SOLVED = 1e-9
SHORT = 1e-6
DIFFERENCE = 2.0**-26
STEPS = 50
HALVINGS = 10

Map = Callable[[Sequence[float]], list[float]]
"""From all torn values, the real ones first, to what one walk makes of them."""


class NoSolution(Exception):  # noqa: N818  # what was found, not a bug
    """Newton's method came no nearer than a *residual*, with *left* of the way to go, and one of them is too large."""

    def __init__(self, residual: float, left: float) -> None:
        super().__init__(residual, left)
        self.residual, self.left = residual, left

    @property
    def is_singular(self) -> bool:
        """Whether the residual is small all the same."""
        return self.residual <= NEARLY_SOLVED


def newton(
    walk: Map, x: Sequence[float], nominals: Sequence[float], stays: Sequence[bool]
) -> tuple[list[float], list[float]]:
    """Values of which the first ``len(nominals)`` are fixed points of *walk*, and what it made of them, called last.

    The other values of *x* are held, and those that the walk leaves as they are: *stays*. Raises NoSolution.
    """
    n = len(nominals)
    x, found = list(x), walk(x)
    rest, left = _residual(x, found, nominals), inf
    for _ in range(STEPS):
        if rest == 0.0 or (rest <= SOLVED and left <= SHORT):
            return x, found
        linear = _factorized(_linearized(walk, x, found, nominals, stays))
        way = _way(linear, x, found) if linear else []
        left = _length(way, x, nominals) if linear else inf
        part, now = 1.0, inf
        trial, moved = x, found
        for _ in range(HALVINGS + 1 if linear and not (rest <= SOLVED and left <= SHORT) else 0):
            if now < rest:
                break
            trial = [x[i] + part * step for i, step in enumerate(way)] + x[n:]
            moved = walk(trial)
            now = _residual(trial, moved, nominals)
            part *= 0.5
        if not now < rest:
            found = walk(x)
            break
        x, found, rest = trial, moved, now
        left = _length(_way(linear, x, found), x, nominals)
    if not (rest <= NEARLY_SOLVED and left <= SHORT):
        raise NoSolution(rest, left)
    return x, found


def same_bits(a: Sequence[float], b: Sequence[float]) -> bool:
    """Whether all numbers are the same, zeros of either sign and all kinds of nan told apart."""
    return pack(f"{len(a)}d", *a) == pack(f"{len(b)}d", *b)


def _residual(x: Sequence[float], found: Sequence[float], nominals: Sequence[float]) -> float:
    largest = 0.0
    for i, nominal in enumerate(nominals):
        part = abs(found[i] - x[i]) / _larger(_larger(nominal, abs(x[i])), abs(found[i]))
        if not isfinite(part):
            return inf
        largest = _larger(largest, part)
    return largest


def _larger(a: float, b: float) -> float:
    return a if a > b else b


def _linearized(
    walk: Map, x: list[float], found: Sequence[float], nominals: Sequence[float], stays: Sequence[bool]
) -> list[list[float]]:
    n = len(nominals)
    rows = [[0.0] * n for _ in range(n)]
    for c in range(n):
        if stays[c]:
            rows[c][c] = 1.0
            continue
        there = list(x)
        there[c] = x[c] + DIFFERENCE * _larger(nominals[c], abs(x[c]))
        difference = there[c] - x[c]
        moved = walk(there)
        for r in range(n):
            rows[r][c] = (1.0 if r == c else 0.0) - (moved[r] - found[r]) / difference
    return rows


Factors = tuple[list[list[float]], list[int]]
"""Both triangles in one matrix, and the row that was taken for each pivot."""


def _factorized(rows: list[list[float]]) -> Factors | None:
    """Gauss with pivots by column; None if the matrix is singular."""
    n = len(rows)
    order = []
    for c in range(n):
        pivot = c
        for r in range(c + 1, n):
            if abs(rows[r][c]) > abs(rows[pivot][c]):
                pivot = r
        if not (abs(rows[pivot][c]) > 0.0 and isfinite(rows[pivot][c])):
            return None
        order.append(pivot)
        rows[c], rows[pivot] = rows[pivot], rows[c]
        for r in range(c + 1, n):
            rows[r][c] /= rows[c][c]
            for i in range(c + 1, n):
                rows[r][i] -= rows[r][c] * rows[c][i]
    return rows, order


def _way(linear: Factors | None, x: Sequence[float], found: Sequence[float]) -> list[float]:
    """From *x* to the solution of the linearization."""
    rows, order = linear or ([], [])
    way = [found[r] - x[r] for r in range(len(rows))]
    for c, pivot in enumerate(order):
        way[c], way[pivot] = way[pivot], way[c]
    for r in range(len(rows)):
        for i in range(r):
            way[r] -= rows[r][i] * way[i]
    for r in reversed(range(len(rows))):
        for i in range(r + 1, len(rows)):
            way[r] -= rows[r][i] * way[i]
        way[r] /= rows[r][r]
    return way


def _length(way: Sequence[float], x: Sequence[float], nominals: Sequence[float]) -> float:
    """Largest part of *way*, relative to the values' size; infinite if there is none to speak of."""
    longest = 0.0
    for i, nominal in enumerate(nominals):
        part = abs(way[i]) / _larger(nominal, abs(x[i]))
        if not isfinite(part):
            return inf
        longest = _larger(longest, part)
    return longest
