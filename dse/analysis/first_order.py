"""How much of a metric's variance each factor explains by itself, from whatever runs there are.

First-order Sobol' indices from given data (Plischke, Borgonovo, Smith 2013): the variance of the means of bins, by the
adjusted coefficient of determination (Ezekiel 1930), so that chance among bins is no share.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.analysis.bins import binned
from dse.analysis.cells import effective
from dse.analysis.data import Floats, StudyData
from dse.analysis.once import once
from dse.analysis.probability import Interval

LEAST = 20
"""Fewer runs than that are not asked for shares."""

_BINS = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
_LEAST_A_BIN = 6
_NORMAL = 1.96
_ASSOCIATED = 0.3
_ROUNDING = 1e-12


@dataclass(frozen=True, slots=True)
class Share:
    """Of the variance of a metric over the space, what *factor* explains by itself, from *runs* runs that have it."""

    factor: str
    share: Interval
    runs: int


@once
def first_order_shares(data: StudyData, metric: str) -> tuple[Share, ...]:
    """The share of each factor, in the order of the factors, of what varies where the metric is defined.

    Shares add up to 1 at most where factors are independent; what they leave is due to several factors together, or to
    bins that are too wide for few runs. Intervals are 1.96 standard deviations to either side, by the jackknife.
    A factor of which fewer than 20 runs have a value is left out. Raises DseError, as `StudyData.response` does.
    """
    there, values = data.response(metric, LEAST)
    found = []
    for k, factor in enumerate(there.factors):
        rows, bins = _best_bins(_binnings(there, k), values, there.weights)
        y, weights = values[rows], there.weights[rows]
        if len(y) < LEAST or not bins.any() or not np.ptp(y):
            continue
        freedom = effective(weights)
        estimate = _explained(bins, y, weights, freedom)
        spread = _NORMAL * _deviation(bins, y, weights, freedom)
        share = Interval(*np.clip([estimate, estimate - spread, estimate + spread], 0.0, 1.0).tolist())
        found.append(Share(factor.name, share, len(y)))
    return tuple(found)


@once
def going_together(data: StudyData) -> tuple[tuple[str, str], ...]:
    """Pairs of factors that are not independent in these runs: what one of them explains, the other does as well.

    By Cramér's V of four bins each, corrected for chance (Bergsma 2013), of more than 0.3; none in fewer than 20 runs.
    """
    pairs, found = [], []
    for k, factor in enumerate(data.factors):
        rows, bins = binned(data.places[:, k], factor, 4)
        everywhere = np.full(len(data), -1)
        everywhere[rows] = bins
        found.append(everywhere)
        for j in range(k):
            both = (found[j] >= 0) & (found[k] >= 0)
            if both.sum() >= LEAST and _cramers_v(found[k][both], found[j][both]) > _ASSOCIATED:
                pairs.append((data.factors[j].name, factor.name))
    return tuple(pairs)


@once
def _binnings(data: StudyData, k: int) -> tuple[tuple[NDArray[np.bool_], NDArray[np.intp]], ...]:
    """The bins of factor *k*, few and then more, as many as its runs bear."""
    found = [binned(data.places[:, k], data.factors[k], _BINS[0])]
    for most in _BINS[1:]:
        rows, bins = binned(data.places[:, k], data.factors[k], most)
        if len(bins) < max(_LEAST_A_BIN * (int(bins.max(initial=0)) + 1), LEAST):
            break
        if not np.array_equal(bins, found[-1][1]):
            found.append((rows, bins))
    return tuple(found)


def _best_bins(
    binnings: tuple[tuple[NDArray[np.bool_], NDArray[np.intp]], ...], values: Floats, weights: Floats
) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
    """As many bins as leave least unexplained, each bin having its price (generalised cross-validation)."""
    best, least = binnings[0], np.inf
    for rows, bins in binnings:
        count = int(bins.max(initial=0)) + 1
        left = _unexplained(bins, values[rows], weights[rows])
        left /= max(1 - count / max(effective(weights[rows]), 1), 1e-9) ** 2
        if left < least * (1 - 1e-9):
            best, least = (rows, bins), left
    return best


def _unexplained(bins: NDArray[np.intp], y: Floats, weights: Floats) -> float:
    """The variance within bins; those without weight have none."""
    total = np.bincount(bins, weights)
    means = np.bincount(bins, weights * y) / np.where(total > 0, total, 1.0)
    return float((weights * (y - means[bins]) ** 2).sum() / max(weights.sum(), 1e-300))


def _explained(bins: NDArray[np.intp], y: Floats, weights: Floats, freedom: float) -> float:
    count = int(bins.max()) + 1
    total = _unexplained(np.zeros_like(bins), y, weights)
    if total <= 0 or freedom <= count:
        return 0.0
    return 1 - _unexplained(bins, y, weights) / total * (freedom - 1) / (freedom - count)


def _deviation(bins: NDArray[np.intp], y: Floats, weights: Floats, freedom: float) -> float:
    """Standard deviation of what is explained, by what it is without each run (the jackknife, Efron 1982)."""
    count, runs = int(bins.max()) + 1, len(y)
    whole = _left_out(np.zeros_like(bins), y, weights)
    if freedom <= count:
        return 0.0
    # A run without which all others are alike.
    changes = whole > _ROUNDING * whole.max()
    ratio = np.where(changes, _left_out(bins, y, weights) / np.where(changes, whole, 1.0), 1.0)
    return float(np.sqrt((runs - 1) * ratio.var()) * (freedom - 1) / (freedom - count))


def _left_out(bins: NDArray[np.intp], y: Floats, weights: Floats) -> Floats:
    """The weighted squares within bins without each run in turn, (n,)."""
    total = np.bincount(bins, weights)
    means = np.bincount(bins, weights * y) / np.where(total > 0, total, 1.0)
    squares, own = weights * (y - means[bins]) ** 2, total[bins]
    # Without a run its bin has another mean.
    rest = own - weights
    alone = rest <= _ROUNDING * own
    gone = np.where(alone, squares, squares * own / np.where(alone, 1.0, rest))
    return np.asarray(squares.sum() - gone, dtype=np.float64)


def _cramers_v(a: NDArray[np.intp], b: NDArray[np.intp]) -> float:
    rows, columns = int(a.max()) + 1, int(b.max()) + 1
    table = np.bincount(a * columns + b, minlength=rows * columns).reshape(rows, columns).astype(np.float64)
    table = table[table.any(axis=1)][:, table.any(axis=0)]
    n, (rows, columns) = len(a), table.shape
    expected = np.outer(table.sum(axis=1), table.sum(axis=0)) / n
    square = ((table - expected) ** 2 / expected).sum() / n - (rows - 1) * (columns - 1) / (n - 1)
    least = min(rows - (rows - 1) ** 2 / (n - 1), columns - (columns - 1) ** 2 / (n - 1)) - 1
    return float(np.sqrt(max(square, 0.0) / least)) if least > 0 else 0.0
