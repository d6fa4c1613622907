"""A region of which every run tells only whether it lies in it: a Gaussian process classifier.

Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, section 3.6: expectation propagation, all sites
at once.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from dse.exploration.level_set import MOST_FITTED, Array, LevelSet, Rows, Shape, matern, solved

Bools = NDArray[np.bool_]

# The process's variance in units of what blurs the border: runs are exact, so that there is next to no blur.
_VARIANCE = 1e4
_NUGGET = 1 / _VARIANCE
_LENGTHS = 2.0 ** np.arange(-4, 4)
_STEPS = (2.0, 2.0**0.5)
_DIGITS = 6
_SWEEPS = 10
_DAMPED = 0.8
_MOST = 600
# One bit at a point that is even takes this part of the variance: that of half a normal distribution is 1 - 2 / pi.
_BIT = 2 / np.pi


def region(points: Array, inside: Bools, shape: Shape) -> LevelSet:
    """Positive in the region; of *points*, (n, d), it is known which are *inside*, (n,).

    Of many, those that tell most are taken.
    """
    rows = informative(points, inside, _MOST)
    precision, shift, _ = _sites(points[rows], inside[rows], shape)
    scale = np.sqrt(_VARIANCE)
    values, noise = shift / precision / scale, 1 / (precision * _VARIANCE)
    # A border nobody has seen is found by filling the ranges, not at their edges, where the least is known.
    return LevelSet(points[rows], shape, values, noise, 0.0, 1.0, learnt=_BIT if inside.any() else 0.0)


def most_informative_shape(points: Array, inside: Bools) -> Shape:
    """The shape with which each of *points*, (n, d), is foretold best by the others whether it is *inside*, (n,)."""
    if inside.all() or not inside.any():
        return Shape(np.ones(points.shape[1]), _NUGGET)
    rows = informative(points, inside, MOST_FITTED)
    return _cheapest(lambda shape: -_sites(points[rows], inside[rows], shape)[2], points.shape[1])


def _cheapest(cost: Callable[[Shape], float], dimensions: int) -> Shape:
    """The shape of least *cost*: all lengths equal first, then one by one, in steps.

    Costs are compared by six digits: on every machine the same is found.
    """
    starts = [Shape(np.full(dimensions, length), _NUGGET) for length in _LENGTHS]
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


def informative(points: Array, inside: Bools, most: int) -> Rows:
    """At most so many of *points*, (n, d), in their order: half of them nearest to one of the other kind, then evenly.

    Without those far off, nothing would be known there.
    """
    from scipy.spatial import cKDTree

    if len(points) <= most:
        return np.arange(len(points))
    apart = np.zeros(len(points))
    if inside.any() and not inside.all():
        apart[inside] = cKDTree(points[~inside]).query(points[inside])[0]
        apart[~inside] = cKDTree(points[inside]).query(points[~inside])[0]
    order = np.argsort(np.round(apart, 9), kind="stable")
    rest = np.sort(order[most // 2 :])
    even = rest[np.arange(most - most // 2) * len(rest) // (most - most // 2)]
    return np.sort(np.concatenate([order[: most // 2], even]))


def _sites(points: Array, inside: Bools, shape: Shape) -> tuple[Array, Array, float]:
    """What stands for each bit: a normal factor by its precision and precision times mean, (n,), both.

    Last, the log of how probable each bit is by all others, summed.
    """
    from scipy.special import log_ndtr

    sign, count = np.where(inside, 1.0, -1.0), len(points)
    prior = _VARIANCE * matern(points, points, shape)
    precision, shift, score = np.full(count, 1e-3), np.zeros(count), 0.0
    for _ in range(_SWEEPS):
        root = np.sqrt(precision)
        inner = solved(np.linalg.cholesky(np.eye(count) + root[:, None] * prior * root), root[:, None] * prior)
        variance = np.maximum(_VARIANCE - (inner**2).sum(axis=0), 1e-10)
        mean = prior @ shift - inner.T @ (inner @ shift)
        # The surrogate without the bit, then with it, (3.57) and (3.58); what the bit adds becomes its factor, (3.59).
        others = np.maximum(1 / variance - precision, 1e-10)
        from_others = (mean / variance - shift) / others
        blurred = np.sqrt(1 + 1 / others)
        z = sign * from_others / blurred
        log_probable = log_ndtr(z)
        ratio = np.exp(-(z**2) / 2 - log_probable) / np.sqrt(2 * np.pi)
        with_bit = from_others + sign * ratio / (others * blurred)
        left = 1 / others - ratio * (z + ratio) / (others * blurred) ** 2
        wanted = np.maximum(1 / left - others, 1e-8)
        moved = with_bit / left - from_others * others
        precision, shift = precision + _DAMPED * (wanted - precision), shift + _DAMPED * (moved - shift)
        score = float(log_probable.sum())
    return precision, shift, score
