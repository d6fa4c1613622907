"""A function known at some points, and where its sign is in doubt: a Gaussian process.

Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006: algorithm 2.1, and (5.8) for the likelihood.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

_LENGTHS = 2.0 ** np.arange(-4, 4)
_STEPS = (2.0, 2.0**0.5)
_NUGGETS = (1e-8, 1e-6, 1e-4)
_MOST_FITTED = 150
_LEAST_DEVIATION = 1e-3
_LEAST_VARIANCE = 1e-12
_DIGITS = 6


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """How a process varies: over *lengths*, (d,), of the unit cube; *nugget* is what of its variance has no length."""

    lengths: Array
    nugget: float


class LevelSet:
    """A process over the unit cube, told *values*, (n,), at *points*, (n, d), n at least 1.

    Its covariance is Matérn's with nu = 5/2; *noise*, (n,), is the variance each value is known with, *mean* and
    *deviation* are the process's before it is told anything, the noise in the deviation's square. *learnt* is which
    part of what is not known at a point a run there tells.
    """

    def __init__(
        self, points: Array, shape: Shape, values: Array, noise: Array, mean: float, deviation: float, learnt: float
    ) -> None:
        self.points, self.shape, self.mean, self.deviation, self.learnt = points, shape, mean, deviation, learnt
        self.factor = _factor(matern(points, points, shape) + np.diag(noise))
        self.whitened = solved(self.factor, values - mean) / deviation

    @classmethod
    def through(cls, points: Array, values: Array, shape: Shape, learnt: float = 1.0) -> LevelSet:
        """The process through *values*, its deviation the likeliest."""
        mean, noise = float(values.mean()), np.full(len(points), shape.nugget)
        found = cls(points, shape, values, noise, mean, 1.0, learnt)
        found.deviation = _deviation(found.whitened)
        found.whitened = found.whitened / found.deviation
        return found

    def at(self, points: Array) -> Posterior:
        """What is believed at *points*, (m, d)."""
        return Posterior(self, points)


class Posterior:
    """What a *level_set* tells at *points*, (m, d): *mean*, (m,), and `deviation`, in the values' unit."""

    def __init__(self, level_set: LevelSet, points: Array) -> None:
        self._set, self._points = level_set, points
        self._known = solved(level_set.factor, matern(level_set.points, points, level_set.shape))
        self._included: list[Array] = []
        self._variance = 1 - (self._known**2).sum(axis=0)
        self.mean = level_set.mean + level_set.deviation * (self._known.T @ level_set.whitened)

    @property
    def deviation(self) -> Array:
        """Of the belief at each point; more than 0."""
        return np.asarray(self._set.deviation * np.sqrt(self._unsure))

    @property
    def _unsure(self) -> Array:
        return np.asarray(np.maximum(self._variance, _LEAST_VARIANCE))

    def positive(self) -> Array:
        """The probability that the function is positive, (m,)."""
        from scipy.special import ndtr

        return np.asarray(ndtr(self.mean / self.deviation), dtype=np.float64)

    def relief(self, asked: Rows, rows: Rows) -> Array:
        """By how much a run at each of the points *asked* lessens p (1 - p) at the points *rows*, as expected.

        (asked, rows); p is the probability of a positive sign. The expectation is 2 T(z, 1) - 2 T(z, h), T Owen's
        function, z mean over deviation, h = tan(arccos(r) / 2), r the part of the variance a run would take (Bect et
        al., Sequential design of computer experiments for the estimation of a probability of failure, 2012). The
        integral T is taken at the middle of its range.
        """
        part = self._set.learnt * self._covariance(asked, rows) ** 2
        part = np.minimum(part / (self._unsure[asked] + self._set.shape.nugget)[:, None] / self._unsure[rows], 1.0)
        z = self.mean[rows] / self.deviation[rows]
        middle = (np.arccos(part) + np.pi / 2) / 2
        return np.asarray(np.arcsin(part) / (2 * np.pi) * np.exp(-(z**2) / (1 + np.cos(middle))), dtype=np.float64)

    def include(self, index: int) -> None:
        """Be as sure as if there were a run at that point, too, that gives what is believed."""
        near = self._covariance(np.array([index]), np.arange(len(self.mean)))[0]
        row = near * np.sqrt(self._set.learnt / (self._unsure[index] + self._set.shape.nugget))
        self._included.append(row)
        self._variance = self._variance - row**2

    def _covariance(self, first: Rows, second: Rows) -> Array:
        prior = matern(self._points[first], self._points[second], self._set.shape)
        left = prior - self._known[:, first].T @ self._known[:, second]
        for row in self._included:
            left = left - np.outer(row[first], row[second])
        return left


def likeliest(points: Array, values: Array) -> Shape:
    """The shape that makes *values*, (n,), at *points*, (n, d), likeliest, by a few of them."""
    stride = -(-len(points) // _MOST_FITTED)
    few, theirs = points[::stride], values[::stride] - values.mean()

    def cost(shape: Shape) -> float:
        factor = _factor(matern(few, few, shape) + shape.nugget * np.eye(len(few)))
        deviation = _deviation(solved(factor, theirs))
        return float(len(few) * np.log(deviation) + np.log(np.diag(factor)).sum())

    return cheapest(cost, points.shape[1], _NUGGETS)


def cheapest(cost: Callable[[Shape], float], dimensions: int, nuggets: tuple[float, ...]) -> Shape:
    """The shape of least *cost*: all lengths equal first, then one by one, in steps.

    Costs are compared by six digits: on every machine the same is found.
    """
    starts = [Shape(np.full(dimensions, length), nugget) for length in _LENGTHS for nugget in nuggets]
    costs = [round(cost(shape), _DIGITS) for shape in starts]
    least = min(costs)
    best = starts[costs.index(least)]
    for step in _STEPS:
        for variable in [*range(dimensions)] * 2:
            for change in (1 / step, step):
                other = _changed(best, variable, change)
                while other and (now := round(cost(other), _DIGITS)) < least:
                    best, least, other = other, now, _changed(other, variable, change)
    return best


def _changed(shape: Shape, variable: int, change: float) -> Shape | None:
    lengths = shape.lengths.copy()
    lengths[variable] *= change
    is_within = _LENGTHS[0] * 0.99 < lengths[variable] < _LENGTHS[-1] * 1.01
    return Shape(lengths, shape.nugget) if is_within else None


def _deviation(whitened: Array) -> float:
    """The likeliest standard deviation; not 0, so that values that are all the same leave some doubt."""
    return max(float(np.sqrt(np.mean(whitened**2))), _LEAST_DEVIATION)


def matern(first: Array, second: Array, shape: Shape) -> Array:
    """Matérn's covariance of variance 1 between *first*, (n, d), and *second*, (m, d)."""
    from scipy.spatial.distance import cdist

    distance = np.sqrt(5.0) * cdist(first / shape.lengths, second / shape.lengths)
    return np.asarray((1 + distance + distance**2 / 3) * np.exp(-distance), dtype=np.float64)


def solved(factor: Array, right: Array) -> Array:
    """The lower triangular *factor*, inverted, times *right*."""
    from scipy.linalg import solve_triangular

    return cast(Array, solve_triangular(factor, right, lower=True, check_finite=False))


def _factor(covariance: Array) -> Array:
    """The Cholesky factor; of points that lie together too closely, with as much more noise as it takes."""
    more = 0.0
    while True:
        try:
            return cast(Array, np.linalg.cholesky(covariance + more * np.eye(len(covariance))))
        except np.linalg.LinAlgError:
            more = max(100 * more, 1e-8)
