"""Newton's method in plain Python: the same operations in the same order as in newton.h, and so the same bits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf, isfinite
from struct import pack

SOLVED = 1e-12
NEARLY_SOLVED = 1e-9
DIFFERENCE = 2.0**-26
STEPS = 50
HALVINGS = 10

Map = Callable[[Sequence[float]], list[float]]
"""From all torn values, the real ones first, to what one walk makes of them."""


class NoSolution(Exception):  # noqa: N818  # what was found, not a bug
    """Newton's method came no nearer than a *residual* that is too large."""

    def __init__(self, residual: float) -> None:
        super().__init__(residual)
        self.residual = residual


def newton(walk: Map, x: Sequence[float], nominals: Sequence[float]) -> tuple[list[float], list[float]]:
    """Values of which the first ``len(nominals)`` are fixed points of *walk*, and what it made of them, called last.

    The other values of *x* are held. Raises NoSolution.
    """
    n = len(nominals)
    x, found = list(x), walk(x)
    rest = _residual(x, found, nominals)
    for _ in range(STEPS):
        if rest <= SOLVED:
            break
        way = _solved(_linearized(walk, x, found, nominals))
        part, now = 1.0, inf
        trial, moved = x, found
        for _ in range(HALVINGS + 1 if way else 0):
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
    if not rest <= NEARLY_SOLVED:
        raise NoSolution(rest)
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


def _linearized(walk: Map, x: list[float], found: Sequence[float], nominals: Sequence[float]) -> list[list[float]]:
    n = len(nominals)
    rows = [[0.0] * n + [found[r] - x[r]] for r in range(n)]
    for c in range(n):
        there = list(x)
        there[c] = x[c] + DIFFERENCE * _larger(nominals[c], abs(x[c]))
        difference = there[c] - x[c]
        moved = walk(there)
        for r in range(n):
            rows[r][c] = (1.0 if r == c else 0.0) - (moved[r] - found[r]) / difference
    return rows


def _solved(rows: list[list[float]]) -> list[float]:
    """Gauss with pivots by column; nothing if the matrix is singular."""
    n = len(rows)
    for c in range(n):
        pivot = c
        for r in range(c + 1, n):
            if abs(rows[r][c]) > abs(rows[pivot][c]):
                pivot = r
        if not (abs(rows[pivot][c]) > 0.0 and isfinite(rows[pivot][c])):
            return []
        rows[c], rows[pivot] = rows[pivot], rows[c]
        for r in range(c + 1, n):
            times = rows[r][c] / rows[c][c]
            for i in range(c + 1, n + 1):
                rows[r][i] -= times * rows[c][i]
    solution = [0.0] * n
    for r in reversed(range(n)):
        rest = rows[r][n]
        for i in range(r + 1, n):
            rest -= rows[r][i] * solution[i]
        solution[r] = rest / rows[r][r]
    return solution
