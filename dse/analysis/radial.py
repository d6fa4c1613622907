"""Formulas that stand for runs, small enough to travel: radial functions through a few centres, with a linear tail.

``s(f) = sum(w_j |f - f_j|^p) + t . (1, f)`` by least squares (the kernels of Wendland, Scattered Data
Approximation, 8.3), p = 1 or 3, whichever errs less in runs that were left out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.analysis.data import Factor, Floats
from dse.analysis.mixing import Mixing, Pair, Part, Predict
from dse.analysis.probability import Interval

POWERS = (1, 3)
MOST_CENTRES = 200
MOST_RUNS = 2000
_FOLDS = 5
_SEED = 0
_RIDGE = 1e-10
_MOST_MIXED = 20_000
_LEAST_MIXED = 20
_MIXES = 4


@dataclass(frozen=True, slots=True, eq=False)
class Formula:
    """Weights of one response, (centres + 1 + features,), with the errors that it makes in runs left out.

    *totals* is what of the variance each factor has to do with, *pairs* what depends on two of them (`Mixing`).
    """

    power: int
    weights: Floats
    error: float
    explained: float
    totals: tuple[Interval, ...] = ()
    pairs: tuple[Pair, ...] = ()


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


def columns_of(factors: tuple[Factor, ...], groups: Sequence[Sequence[int]]) -> list[list[int]]:
    """The columns of `features` that each of *groups* of factors, by their positions, has."""
    counts = [len(factor.levels) - 1 if factor.is_choice else 1 for factor in factors]
    ends = np.cumsum(counts).tolist()
    own = [range(end - count, end) for end, count in zip(ends, counts, strict=True)]
    return [[column for k in group for column in own[k]] for group in groups]


def centres_of(points: Floats) -> Floats:
    """At most `MOST_CENTRES` of *points*, (n, features), each the farthest from those before it."""
    points = np.unique(points, axis=0)
    chosen = [int(np.argmin(((points - points.mean(axis=0)) ** 2).sum(axis=1)))]
    away = ((points - points[chosen[0]]) ** 2).sum(axis=1)
    while len(chosen) < min(MOST_CENTRES, len(points)):
        chosen.append(int(np.argmax(np.round(away, 12))))
        away = np.minimum(away, ((points - points[chosen[-1]]) ** 2).sum(axis=1))
    return np.asarray(points[np.sort(chosen)], dtype=np.float64)


def formulas(
    points: Floats, values: Floats, centres: Floats, weights: Floats, columns: Sequence[Sequence[int]]
) -> list[Formula]:
    """A formula through *values*, (n, responses), at *points*, (n, features), for each response.

    Totals and pairs are of factors, each some *columns*, over runs that count *weights*, (n,), 1 on average.
    """
    fold = np.random.default_rng(_SEED).permutation(len(points)) % _FOLDS
    fitted: list[_Fold] = []
    predicted = {power: np.empty_like(values) for power in POWERS}
    for number in range(_FOLDS):
        train = fold != number
        fitted.append(_Fold.through(points[train], values[train]))
        for power, found in fitted[-1].weights.items():
            predicted[power][~train] = evaluated(points[~train], fitted[-1].centres, found, power)
    squares = {power: ((each - values) ** 2).mean(axis=0) for power, each in predicted.items()}
    first, last = POWERS
    powers = np.where(squares[last] < squares[first], last, first)
    mixing = _mixing(points, values, weights, columns, fold, [each.of(powers) for each in fitted])
    whole = {power: _fitted(points, values, centres, power) for power in POWERS}
    variance = values.var(axis=0)
    return [
        Formula(
            power,
            whole[power][:, k],
            float(squares[power][k] ** 0.5),
            float(1 - squares[power][k] / variance[k]),
            mixing.totals(k),
            mixing.pairs(k),
        )
        for k, power in enumerate(powers.tolist())
    ]


@dataclass(frozen=True, slots=True, eq=False)
class _Fold:
    """Formulas of all responses, of each power."""

    centres: Floats
    weights: Mapping[int, Floats]

    @classmethod
    def through(cls, points: Floats, values: Floats) -> _Fold:
        near = centres_of(points)
        return cls(near, {power: _fitted(points, values, near, power) for power in POWERS})

    def of(self, powers: NDArray[np.int64]) -> Predict:
        """All responses at points, each by the formula of its power."""

        def predict(points: Floats) -> Floats:
            found = np.empty((len(points), len(powers)))
            for power in POWERS:
                mine = powers == power
                if mine.any():
                    found[:, mine] = evaluated(points, self.centres, self.weights[power][:, mine], power)
            return found

        return predict


def _mixing(
    points: Floats,
    values: Floats,
    weights: Floats,
    columns: Sequence[Sequence[int]],
    fold: NDArray[np.intp],
    models: Sequence[Predict],
) -> Mixing:
    """The runs that each model has not seen, mixed up to four times; of many factors fewer of them."""
    most = max(_MOST_MIXED // (_FOLDS * max(len(columns), 1)), _LEAST_MIXED)
    parts = []
    for number, predict in enumerate(models):
        rows = drawn(np.flatnonzero(fold == number), most)
        parts.append(Part(predict, points[rows], values[rows], weights[rows]))
    mixed = max(len(columns) * sum(len(part.points) for part in parts), 1)
    return Mixing(columns, parts, min(max(_MOST_MIXED // mixed, 1), _MIXES))


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
