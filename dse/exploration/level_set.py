"""A function known at some points, and where its sign is in doubt: a Gaussian process.

Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006: algorithm 2.1, and (5.8) for the likelihood.
"""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LENGTHS = 2.0 ** np.arange(-4, 3)
_NUGGETS = (1e-6, 1e-4)
_MOST_FITTED = 150
_LEAST_DEVIATION = 1e-3
_DIGITS = 6


class LevelSet:
    """The process through *values*, (n,), at *points*, (n, d), n at least 1, of the unit cube.

    Its covariance is Matérn's with nu = 5/2 and a length for each variable; lengths and nugget are those of a coarse
    grid that make the values likeliest, likelihoods being compared by six digits: on every machine the same.
    *blur* times the distance to the nearest point is added to what is not known, as a standard deviation.
    """

    def __init__(self, points: Array, values: Array, blur: float = 0.0) -> None:
        self.points, self.blur = points, blur
        self.mean = float(values.mean())
        self.lengths, self.nugget = _likeliest(points, values - self.mean)
        self.factor = _factor(points, self.lengths, self.nugget)
        self.whitened = _solved(self.factor, values - self.mean)
        self.deviation = _deviation(self.whitened)

    def at(self, points: Array) -> Posterior:
        """What is believed at *points*, (m, d)."""
        return Posterior(self, points)


def border(points: Array, inside: NDArray[np.bool_]) -> LevelSet:
    """Positive in a region of which it is known which of *points*, (n, d), are *inside*: the distance to its border.

    Known is the distance to the nearest point of the other kind, which is an upper bound; and no point tells more about
    the border than that it is not within the distance to the next: without the blur, runs would crowd at a few places.
    """
    from scipy.spatial.distance import cdist

    distance = np.full(len(points), np.sqrt(points.shape[1]))
    if inside.any() and not inside.all():
        apart = cdist(points[inside], points[~inside])
        distance[inside], distance[~inside] = apart.min(axis=1), apart.min(axis=0)
    return LevelSet(points, np.where(inside, distance, -distance), blur=1.0)


class Posterior:
    """What a *level_set* tells at *points*, (m, d): *mean* and *deviation*, (m,), in the values' unit."""

    def __init__(self, level_set: LevelSet, points: Array) -> None:
        from scipy.spatial.distance import cdist

        self._set, self._points = level_set, points
        self._known = _solved(level_set.factor, _matern(level_set.points, points, level_set.lengths))
        self._included: list[Array] = []
        self._variance = 1 - (self._known**2).sum(axis=0)
        self._nearest = cdist(level_set.points, points).min(axis=0)
        self.mean = level_set.mean + self._known.T @ level_set.whitened

    @property
    def deviation(self) -> Array:
        """Of the belief at each point; more than 0."""
        known = self._set.deviation * np.sqrt(np.maximum(self._variance, 1e-12))
        return cast(Array, np.hypot(known, self._set.blur * self._nearest))

    def positive(self) -> Array:
        """The probability that the function is positive, (m,)."""
        from scipy.special import ndtr

        return np.asarray(ndtr(self.mean / self.deviation), dtype=np.float64)

    def doubt(self) -> Array:
        """The probability that the sign of the mean is wrong, times the deviation: where a point tells most, (m,)."""
        positive = self.positive()
        return np.minimum(positive, 1 - positive) * self.deviation

    def include(self, index: int) -> None:
        """Be as sure as if the function were known at that point, too, to be what it is believed to be."""
        near = _matern(self._points[index : index + 1], self._points, self._set.lengths)[0]
        left = near - self._known[:, index] @ self._known - sum(row[index] * row for row in self._included)
        row = left / np.sqrt(max(self._variance[index], 0.0) + self._set.nugget)
        self._included.append(row)
        self._variance = self._variance - row**2
        self._nearest = np.minimum(self._nearest, np.linalg.norm(self._points - self._points[index], axis=1))


def _likeliest(points: Array, values: Array) -> tuple[Array, float]:
    """Lengths, (d,), and nugget; by *values* of mean 0 at a few of the points, equal lengths first, then one by one."""
    stride = -(-len(points) // _MOST_FITTED)
    few, theirs = points[::stride], values[::stride]

    def unlikely(lengths: Array, nugget: float) -> float:
        factor = _factor(few, lengths, nugget)
        whitened = _solved(factor, theirs)
        return round(float(len(few) * np.log(_deviation(whitened)) + np.log(np.diag(factor)).sum()), _DIGITS)

    dimensions = points.shape[1]
    starts = [(np.full(dimensions, length), nugget) for length in _LENGTHS for nugget in _NUGGETS]
    costs = [unlikely(*start) for start in starts]
    least = min(costs)
    lengths, nugget = starts[costs.index(least)]
    for variable in [*range(dimensions)] * 2:
        for change in (0.5, 2.0):
            other = lengths.copy()
            other[variable] *= change
            while _LENGTHS[0] <= other[variable] <= _LENGTHS[-1] and (cost := unlikely(other, nugget)) < least:
                lengths, least, other = other, cost, other.copy()
                other[variable] *= change
    return lengths, nugget


def _deviation(whitened: Array) -> float:
    """The likeliest standard deviation; not 0, so that values that are all the same leave some doubt."""
    return max(float(np.sqrt(np.mean(whitened**2))), _LEAST_DEVIATION)


def _matern(first: Array, second: Array, lengths: Array) -> Array:
    from scipy.spatial.distance import cdist

    distance = np.sqrt(5.0) * cdist(first / lengths, second / lengths)
    return np.asarray((1 + distance + distance**2 / 3) * np.exp(-distance), dtype=np.float64)


def _factor(points: Array, lengths: Array, nugget: float) -> Array:
    return cast(Array, np.linalg.cholesky(_matern(points, points, lengths) + nugget * np.eye(len(points))))


def _solved(factor: Array, right: Array) -> Array:
    from scipy.linalg import solve_triangular

    return cast(Array, solve_triangular(factor, right, lower=True, check_finite=False))
