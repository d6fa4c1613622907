"""How probable a failure is that hardly ever happens: importance sampling, led to the failures level by level.

Points are standard normal, d independent numbers. A run has a score, negative if it fails, which decreases towards a
failure. Half of the first batch is drawn from the standard normal density f, half from one 2.5 times as wide. A level
is the score below which 15 % of a batch are, or 0 if more than that fail. Of all points up to the level, weighted to
stand for f, three normal densities are fitted, and the next batch is drawn from them, one in five from the wide one:
its points find failures in other places. Two batches after the level is 0, the density is final.
The last batch alone, which played no part in the choice of its density q, gives the estimate: the mean of f/q over the
failures (Rubinstein and Kroese, The Cross-Entropy Method, 2004, for levels and fits).

Example: d = 1, a failure beyond 4, so the score is 4 - z; the probability is 3.17e-5. Batches of 200, seed 1:

    batch    drawn mostly around    level    fail
    1        0 (two widths)         2.6      1.5 %
    2        1.8                    1.7      1 %
    3        2.6                    1.1      1 %
    4        3.2                    0.4      6 %
    5        3.9                    0        32 %
    6, 7     4.3, 4.2               0        67, 68 %
    last     4.2                             270 of 400: the mean of f/q is 3.22e-5, 2.90e-5 ... 3.58e-5

Cost: some milliseconds a batch. Coverage of the interval: docs/decisions/0041-rating.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_WIDE = 2.5
_WIDE_SHARE = 0.2
_LEVEL_SHARE = 0.15
_DENSITIES = 3
_ROUNDS = 25
_REFITS = 2
_LEAST_PART = 0.02
_DIGITS = 6
"""Points are rounded, so that the last bits of another machine do not matter."""

_NO_MARGIN = 1e-300
"""A score that leads nowhere."""

_NORMAL_95 = 1.959964


@dataclass(frozen=True, slots=True)
class Probability:
    """The estimate *value* in *low* … *high* with 95 % confidence, by *failing* of *runs* runs of the last batch.

    Without any failure *value* is 0, and *high* rests on the first batch.
    """

    value: float
    low: float
    high: float
    runs: int
    failing: int


@dataclass(frozen=True, slots=True, eq=False)
class _Mixture:
    """Normal densities by their shares (k,), means (k, d) and lower Cholesky factors (k, d, d)."""

    shares: Array
    means: Array
    factors: Array

    def parts(self, points: Array) -> Array:
        """The logarithm of each density, times its share, at *points* (n, d): (k, n)."""
        found = []
        for share, mean, factor in zip(self.shares, self.means, self.factors, strict=True):
            away = np.linalg.solve(factor, (points - mean).T)
            found.append(math.log(share) - np.log(np.diag(factor)).sum() + _log_normal(away.T))
        return np.array(found)

    def log(self, points: Array) -> Array:
        """The logarithm of the density, (n,)."""
        return np.asarray(np.logaddexp.reduce(self.parts(points), axis=0))

    def draw(self, count: int, rng: np.random.Generator) -> Array:
        """*count* points, (count, d), rounded."""
        which = rng.choice(len(self.shares), count, p=self.shares)
        steps = rng.standard_normal((count, self.means.shape[1]))
        return np.asarray(np.round(self.means[which] + np.einsum("nij,nj->ni", self.factors[which], steps), _DIGITS))


def _log_normal(points: Array) -> Array:
    return np.asarray(-0.5 * (points**2).sum(axis=1) - 0.5 * points.shape[1] * math.log(2 * math.pi))


@dataclass(slots=True, eq=False)
class RareEvent:
    """A search in *dimension* numbers: *batch* points at a time, at most *levels* times, then *last* for the estimate.

    `ask` and `tell` take turns until `ask` returns no points; then `probability` is the result.
    """

    dimension: int
    batch: int
    last: int
    levels: int
    rng: np.random.Generator
    probability: Probability | None = None
    _points: list[Array] = field(default_factory=list)
    _scores: list[Array] = field(default_factory=list)
    _densities: list[_Mixture] = field(default_factory=list)
    _level: float = math.inf
    _refits: int = _REFITS
    _is_last: bool = False
    _density: _Mixture = field(init=False)

    def __post_init__(self) -> None:
        self._density = self._with_wide(np.ones(1), np.zeros((1, self.dimension)), np.eye(self.dimension)[None], 0.5)

    def ask(self) -> Array:
        """The next points, (n, d); none at the end."""
        if self.probability is not None:
            return np.zeros((0, self.dimension))
        return self._density.draw(self.last if self._is_last else self.batch, self.rng)

    def tell(self, points: Array, scores: Array) -> None:
        """The *scores* (n,) of the *points* that were asked for: negative for a failure, infinite where unknown."""
        if self._is_last:
            self.probability = _estimate(points, scores < 0, self._density)
            return
        self._points.append(points)
        self._scores.append(scores)
        self._densities.append(self._density)
        level = min(self._level, float(np.quantile(scores, _LEVEL_SHARE, method="lower")))
        self._level = level if level > _NO_MARGIN else 0.0
        everything = np.concatenate(self._scores)
        is_over = len(self._points) == self.levels
        chosen = everything < 0 if self._level == 0 or is_over else everything <= self._level
        if chosen.any():
            self._fit(np.concatenate(self._points)[chosen])
        if self._level == 0 and chosen.any():
            self._is_last = self._refits == 0
            self._refits -= 1
        if is_over and not self._is_last:
            self._is_last = bool(chosen.any())
            if not self._is_last:
                self.probability = Probability(0.0, 0.0, _none_seen(self.batch), self.batch, 0)

    def _fit(self, points: Array) -> None:
        """The next density, by *points* of all batches, weighted to stand for the standard normal density."""
        drawn = np.logaddexp.reduce([density.log(points) for density in self._densities], axis=0)
        weights = _log_normal(points) - drawn
        self._density = self._with_wide(*_fitted(points, np.exp(weights - weights.max())), _WIDE_SHARE)

    def _with_wide(self, shares: Array, means: Array, covariances: Array, share: float) -> _Mixture:
        """These densities, and the wide one with *share*."""
        identity = np.eye(self.dimension)
        return _Mixture(
            np.append((1 - share) * shares, share),
            np.vstack([means, np.zeros(self.dimension)]),
            np.linalg.cholesky(np.concatenate([covariances, _WIDE**2 * identity[None]])),
        )


def _fitted(points: Array, weights: Array) -> tuple[Array, Array, Array]:
    """Shares, means and covariances of normal densities for *points* (n, d) with *weights*, by expectation and
    maximization. Covariances are drawn towards the identity as by d + 2 points more."""
    dimension = points.shape[1]
    weights = weights / weights.sum()
    effective = 1 / float((weights**2).sum())
    centres = [points[np.argmax(weights)]]
    while len(centres) < _DENSITIES:
        away = np.min([((points - centre) ** 2).sum(axis=1) for centre in centres], axis=0)
        centres.append(points[np.argmax(away * np.sqrt(weights))])
    shares, means = np.full(_DENSITIES, 1 / _DENSITIES), np.array(centres)
    covariances = np.repeat(0.5 * np.eye(dimension)[None], _DENSITIES, axis=0)
    for _ in range(_ROUNDS):
        factors = np.asarray(np.linalg.cholesky(covariances), dtype=np.float64)
        parts = _Mixture(shares, means, factors).parts(points)
        belongs = np.exp(parts - np.logaddexp.reduce(parts, axis=0)) * weights
        held = belongs.sum(axis=1) + 1e-12
        means = (belongs @ points) / held[:, None]
        for number in range(_DENSITIES):
            away = points - means[number]
            spread = (away.T * belongs[number]) @ away
            prior = dimension + 2
            covariances[number] = (effective * spread + prior * np.eye(dimension)) / (effective * held[number] + prior)
        shares = np.maximum(held / held.sum(), _LEAST_PART)
        shares = shares / shares.sum()
    return np.asarray(shares), np.asarray(means), np.asarray(covariances)


def _estimate(points: Array, fails: NDArray[np.bool_], density: _Mixture) -> Probability:
    """By points drawn from *density*. The interval is even on a logarithmic scale, as the estimate is skewed."""
    failing = int(fails.sum())
    ratios = np.where(fails, np.exp(_log_normal(points) - density.log(points)), 0.0)
    value = float(ratios.mean())
    if not failing:
        return Probability(0.0, 0.0, 1.0, len(points), 0)
    error = float(ratios.std(ddof=1)) / math.sqrt(len(points)) / value
    reach = math.exp(_NORMAL_95 * error)
    return Probability(value, value / reach, min(1.0, value * reach), len(points), failing)


def _none_seen(batch: int) -> float:
    """What is above the probability with 95 % confidence if no point of the first batch fails: each is drawn from f
    with a probability of one half or more, so that it fails with half the probability or more."""
    return min(1.0, 2 * (1 - math.pow(0.05, 1 / batch)))
