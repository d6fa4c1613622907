"""Formulas that stand for runs, small enough to travel: radial functions through a few centres, with a linear tail.

``s(f) = sum(w_j |f - f_j|^p) + t . (1, f)`` by least squares (the kernels of Wendland, Scattered Data
Approximation, 8.3), p = 1 or 3, whichever errs less in runs that were left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.analysis.data import Factor, Floats
from dse.analysis.separable import FOLDS, folds

POWERS = (1, 3)
MOST_CENTRES = 200
MOST_RUNS = 2000
_SEED = 0
_RIDGE = 1e-10


@dataclass(frozen=True, slots=True, eq=False)
class Formula:
    """Weights of one response, (centres + 1 + features,), with the errors that it makes in runs left out."""

    power: int
    weights: Floats
    error: float
    explained: float


def drawn(rows: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    """All of *rows*, or so many of them, each as likely as any other; sorted, the same ones every time."""
    # Every so-manieth would keep one column of a grid only.
    return np.sort(np.random.default_rng(_SEED).permutation(rows)[:most])


def features(places: Floats, factors: tuple[Factor, ...]) -> Floats:
    """Numbers from -1 to 1; of a choice a column for each level but the first, (n, features)."""
    columns: list[Floats] = []
    for factor, column in zip(factors, places.T, strict=True):
        if factor.is_choice:
            level = np.minimum((column * len(factor.levels)).astype(int), len(factor.levels) - 1)
            columns += [(level == number).astype(np.float64) for number in range(1, len(factor.levels))]
        else:
            columns.append(2 * column - 1)
    return np.array(columns, dtype=np.float64).reshape(len(columns), len(places)).T


def centres_of(points: Floats) -> Floats:
    """At most `MOST_CENTRES` of *points*, (n, features), each the farthest from those before it."""
    points = np.unique(points, axis=0)
    chosen = [int(np.argmin(((points - points.mean(axis=0)) ** 2).sum(axis=1)))]
    away = ((points - points[chosen[0]]) ** 2).sum(axis=1)
    while len(chosen) < min(MOST_CENTRES, len(points)):
        chosen.append(int(np.argmax(np.round(away, 12))))
        away = np.minimum(away, ((points - points[chosen[-1]]) ** 2).sum(axis=1))
    return np.asarray(points[np.sort(chosen)], dtype=np.float64)


def formulas(points: Floats, values: Floats, centres: Floats, alike: NDArray[np.intp]) -> list[Formula]:
    """A formula through *values*, (n, responses), at *points*, (n, features), for each response.

    Runs that are *alike*, (n,), by a number (`StudyData.points`), are left out together to judge it.
    """
    fold = folds(alike)
    squares = dict.fromkeys(POWERS, np.zeros(values.shape[1]))
    for number in range(FOLDS):
        train = fold != number
        near = centres_of(points[train])
        for power in POWERS:
            found = _fitted(points[train], values[train], near, power)
            wrong = evaluated(points[~train], near, found, power) - values[~train]
            squares[power] = squares[power] + (wrong**2).sum(axis=0) / len(points)
    first, last = POWERS
    powers = np.where(squares[last] < squares[first], last, first)
    whole = {power: _fitted(points, values, centres, power) for power in POWERS}
    variance = values.var(axis=0)
    return [
        Formula(power, whole[power][:, k], float(squares[power][k] ** 0.5), float(1 - squares[power][k] / variance[k]))
        for k, power in enumerate(powers.tolist())
    ]


def evaluated(points: Floats, centres: Floats, weights: Floats, power: int) -> Floats:
    """The formulas with *weights*, (centres + 1 + features, responses), at *points*."""
    return np.asarray(_basis(points, centres, power) @ weights, dtype=np.float64)


def _fitted(points: Floats, values: Floats, centres: Floats, power: int) -> Floats:
    """By least squares through all points, with a ridge that is too small to be seen."""
    basis = _basis(points, centres, power)
    square = basis.T @ basis
    square[np.diag_indices_from(square)] += _RIDGE * np.trace(square) / len(square)
    return np.asarray(np.linalg.solve(square, basis.T @ values), dtype=np.float64)


def _basis(points: Floats, centres: Floats, power: int) -> Floats:
    from scipy.spatial.distance import cdist

    away = cdist(points, centres)
    # A general power takes ten times as long.
    return np.hstack([away if power == 1 else away * away * away, _tail(points)])


def _tail(points: Floats) -> Floats:
    return np.hstack([np.ones((len(points), 1)), points])
