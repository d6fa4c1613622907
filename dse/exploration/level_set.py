"""A function known at some points, and where its sign is in doubt: a Gaussian process.

Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006: algorithm 2.1, (5.9) for the likelihood and
(5.10) to (5.12) for values that are held out.

Example: x - 0.3, known at 0, 0.5 and 1, with a length scale of 1.

    at                  0.1      0.2      0.3      0.4
    mean               -0.229   -0.140   -0.035    0.080
    deviation           0.034    0.051    0.048    0.029
    probability > 0     0.000    0.003    0.230    0.997      so the sign is in doubt only near 0.3

Cost: the Cholesky factor of n points, n^3 / 3, for each shape that is tried; at most 150 points are fitted. After that
a further point of a batch costs n. Measured: docs/decisions/0025-boundary.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

# Of the unit cube. A smooth function is foretold best with length scales far beyond it.
_LENGTHS = (0.05, 50.0)
_STARTS = (0.3, 1.5, 6.0)
# Above the greatest, kinks would be taken for noise; below the least, rounding errors count.
_NUGGETS = (1e-10, 1e-4)
_NUGGET = 1e-6
MOST_FITTED = 150
_LEAST_DEVIATION = 1e-3
_LEAST_VARIANCE = 1e-12
_COST_DIGITS = 4


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """How a process varies: over *lengths*, (d,), of the unit cube; *nugget* is the part of its variance without a
    length; *smoothness* is Matérn's nu, 5/2 or 3/2."""

    lengths: Array
    nugget: float
    smoothness: float = 2.5


class LevelSet:
    """A process over the unit cube, told *values*, (n,), at *points*, (n, d), n at least 1.

    Its covariance is Matérn's; *noise*, (n,), is the variance each value is known with, *mean* and
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
        """The process through *values*, its mean and deviation the likeliest."""
        noise = np.full(len(points), shape.nugget)
        found = cls(points, shape, values, noise, 0.0, 1.0, learnt)
        one = solved(found.factor, np.ones(len(points)))
        found.mean = float(one @ found.whitened / (one @ one))
        apart = found.whitened - found.mean * one
        # Values that are all the same leave some doubt.
        least = _LEAST_DEVIATION * float(np.abs(values).max() or 1.0)
        found.deviation = max(float(np.sqrt(np.mean(apart**2))), least)
        found.whitened = apart / found.deviation
        return found

    def at(self, points: Array) -> Posterior:
        """What is believed at *points*, (m, d)."""
        return Posterior(self, points)

    def held_out(self) -> float:
        """The log density of each value by all others, summed, less a constant."""
        inverse = solved(self.factor, np.eye(len(self.points)))
        precision = (inverse**2).sum(axis=0)
        errors = inverse.T @ self.whitened / precision
        return float((np.log(precision) - precision * errors**2).sum() / 2 - len(precision) * np.log(self.deviation))


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


def thinned(count: int) -> slice:
    """Which of *count* rows shapes are fitted to: at most 150, evenly."""
    return slice(None, None, -(-count // MOST_FITTED) or 1)


def likeliest(points: Array, values: Array) -> Shape:
    """The shape of the greatest likelihood of *values*, (n,), at *points*, (n, d), by a few of them.

    Mean and variance have closed forms; length scales and nugget are found along the likelihood's gradient, (5.9), from
    three starts, then once more with Matérn's 3/2, likelier where the function has kinks. Each evaluation costs n³.
    Rounded to two digits, they are the same on every machine.
    """
    from scipy.linalg import cho_solve
    from scipy.optimize import Bounds, minimize
    from scipy.spatial.distance import cdist

    few, theirs = points[thinned(len(points))], values[thinned(len(points))]
    width = float(np.abs(theirs - theirs.mean()).max())
    if width <= _LEAST_VARIANCE * float(np.abs(theirs).max()):
        return Shape(np.ones(points.shape[1]), _NUGGET)
    theirs, count, identity = (theirs - theirs.mean()) / width, len(few), np.eye(len(few))

    def cost(logs: Array, smoothness: float) -> tuple[float, Array]:
        scaled, nugget = few * _per_length(np.exp(logs[:-1]), smoothness), np.exp(logs[-1])
        distance = cdist(scaled, scaled)
        fall = np.exp(-distance)
        factor = _factor(_correlation(distance, fall, smoothness) + nugget * identity)
        inverse = cho_solve((factor, True), identity, check_finite=False)
        apart = theirs - (inverse @ theirs).sum() / inverse.sum()
        weights = inverse @ apart
        variance = max(float(apart @ weights) / count, _LEAST_VARIANCE)
        half = (inverse - np.outer(weights, weights) / variance) / 2
        # d correlation / d log length, less the square of the difference in that variable.
        slope = half * fall * ((1 + distance) / 3 if smoothness > 2 else 1.0)
        along = 2 * (slope.sum(axis=0) @ scaled**2 - (scaled * (slope @ scaled)).sum(axis=0))
        value = count * np.log(variance) / 2 + np.log(np.diag(factor)).sum()
        return float(value), np.append(along, nugget * np.trace(half))

    def climbed(start: Array, smoothness: float) -> tuple[float, float, Array]:
        found = minimize(lambda logs, *_: cost(logs, smoothness), start, jac=True, method="L-BFGS-B", bounds=ends)
        return round(float(found.fun), _COST_DIGITS), smoothness, found.x

    lows, highs = ([*[length] * points.shape[1], nugget] for length, nugget in zip(_LENGTHS, _NUGGETS, strict=True))
    ends = Bounds(np.log(lows), np.log(highs))
    starts = [np.log([*[length] * points.shape[1], _NUGGET]) for length in _STARTS]
    smooth = min((climbed(start, 2.5) for start in starts), key=lambda found: found[0])
    _, smoothness, logs = min(smooth, climbed(smooth[2], 1.5), key=lambda found: found[0])
    *lengths, nugget = (float(f"{value:.1e}") for value in np.exp(logs))
    return Shape(np.array(lengths), nugget, smoothness)


def matern(first: Array, second: Array, shape: Shape) -> Array:
    """Matérn's covariance of variance 1 between *first*, (n, d), and *second*, (m, d)."""
    from scipy.spatial.distance import cdist

    scale = _per_length(shape.lengths, shape.smoothness)
    distance = cdist(first * scale, second * scale)
    return _correlation(distance, np.exp(-distance), shape.smoothness)


def _per_length(lengths: Array, smoothness: float) -> Array:
    return np.asarray(np.sqrt(2 * smoothness) / lengths)


def _correlation(distance: Array, fall: Array, smoothness: float) -> Array:
    """*fall* is ``exp(-distance)``."""
    quadratic = distance**2 / 3 if smoothness > 2 else 0.0
    return np.asarray((1 + distance + quadratic) * fall, dtype=np.float64)


def solved(factor: Array, right: Array) -> Array:
    """The lower triangular *factor*, inverted, times *right*."""
    from scipy.linalg import solve_triangular

    return cast(Array, solve_triangular(factor, right, lower=True, check_finite=False))


def _factor(covariance: Array) -> Array:
    """The Cholesky factor; of points that lie together too closely, with as much more noise as it takes."""
    more = 0.0
    while True:
        try:
            return cast(Array, np.linalg.cholesky(covariance + more * np.eye(len(covariance)) if more else covariance))
        except np.linalg.LinAlgError:
            more = max(100 * more, 1e-8)
