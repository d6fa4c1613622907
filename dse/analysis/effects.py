"""What a metric does as a factor changes: means along it, and correlations."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dse.analysis.bins import binned
from dse.analysis.data import StudyData
from dse.analysis.probability import CONFIDENCE, Interval

if TYPE_CHECKING:
    from dse.analysis.data import Floats

_MOST_BINS = 8
_LEAST = 4
_ROUNDING = 1e-12


@dataclass(frozen=True, slots=True)
class MainEffect:
    """The mean of a metric (SI) along a *factor*, bin by bin: *at* are the mean places, *runs* how many there are.

    A bin of one run has a mean without an interval: NaN.
    """

    factor: str
    at: tuple[float, ...]
    means: tuple[Interval, ...]
    runs: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Correlation:
    """Of a metric with a *factor* that is a number: Pearson's, and Spearman's of the ranks, in *runs* runs."""

    factor: str
    pearson: Interval
    spearman: Interval
    runs: int


def main_effects(data: StudyData, metric: str) -> tuple[MainEffect, ...]:
    """Of every factor, over the runs in which the metric is defined and the factor present. Raises DseError."""
    there, values = data.response(metric, _LEAST)
    effects = []
    for k, factor in enumerate(there.factors):
        rows, bins = binned(there.places[:, k], factor, _MOST_BINS)
        kinds = range(int(bins.max()) + 1) if len(bins) else ()
        inside = [values[rows][bins == b] for b in kinds]
        at = tuple(float(there.places[rows, k][bins == b].mean()) for b in kinds)
        effects.append(MainEffect(factor.name, at, tuple(map(_mean, inside)), tuple(map(len, inside))))
    return tuple(effects)


def correlations(data: StudyData, metric: str) -> tuple[Correlation, ...]:
    """Of every factor that is a number and of which more than three runs have different values. Raises DseError.

    Intervals by Fisher's z; that of ranks with the variance of Bonett and Wright (2000).
    """
    import numpy as np

    there, values = data.response(metric, _LEAST)
    found = []
    for k, factor in enumerate(there.factors):
        rows = ~np.isnan(there.places[:, k])
        x, y = there.places[rows, k], values[rows]
        if factor.is_choice or len(x) < _LEAST or not np.ptp(x) or not np.ptp(y):
            continue
        linear, ranked = (float(np.corrcoef(one, other)[0, 1]) for one, other in ((x, y), (_ranks(x), _ranks(y))))
        spread = 1 / math.sqrt(len(x) - 3)
        widened = spread * math.sqrt(1 + ranked * ranked / 2)
        found.append(Correlation(factor.name, _fisher(linear, spread), _fisher(ranked, widened), len(x)))
    return tuple(found)


def _ranks(values: Floats) -> Floats:
    """From 1; equal values share the mean of theirs. scipy.stats has it, too, and takes a second to load."""
    import numpy as np

    _, which, counts = np.unique(values, return_inverse=True, return_counts=True)
    return np.asarray((np.cumsum(counts) - (counts - 1) / 2)[which])


def _mean(values: Floats) -> Interval:
    """With the interval of Student."""
    from scipy.special import stdtrit

    mean = float(values.mean())
    if len(values) < 2:
        return Interval(mean, math.nan, math.nan)
    half = stdtrit(len(values) - 1, 0.5 + CONFIDENCE / 2) * values.std(ddof=1) / math.sqrt(len(values))
    return Interval(mean, mean - float(half), mean + float(half))


def _fisher(correlation: float, spread: float) -> Interval:
    from scipy.special import ndtri

    if abs(correlation) > 1.0 - _ROUNDING:
        return Interval(*[math.copysign(1.0, correlation)] * 3)
    half = float(ndtri(0.5 + CONFIDENCE / 2)) * spread
    z = math.atanh(correlation)
    return Interval(correlation, math.tanh(z - half), math.tanh(z + half))
