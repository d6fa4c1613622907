"""What a metric does as a factor changes: means along it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dse.analysis.bins import binned
from dse.analysis.data import StudyData
from dse.analysis.first_order import inseparable, observations
from dse.analysis.probability import CONFIDENCE, Interval

if TYPE_CHECKING:
    from dse.analysis.data import Floats

_MOST_BINS = 8
_LEAST, _LEAST_EVEN = 4, 40


@dataclass(frozen=True, slots=True)
class MainEffect:
    """The mean of a metric (SI) along a *factor*, bin by bin: *at* are the mean places, *runs* how many there are.

    A bin of one observation (`dse.analysis.first_order`) has a mean without an interval: NaN.
    """

    factor: str
    at: tuple[float, ...]
    means: tuple[Interval, ...]
    runs: tuple[int, ...]


def main_effects(data: StudyData, metric: str) -> tuple[MainEffect, ...]:
    """Of every factor, over the runs in which the metric is defined and the factor present; not of `inseparable` ones.
    Raises DseError.
    """
    there, values = data.evenly(metric, _LEAST_EVEN).response(metric, _LEAST)
    left_out = inseparable(there)
    effects = []
    for k, factor in enumerate(there.factors):
        if factor.name in left_out:
            continue
        along = observations(there, k)
        bins, y = binned(along.places, factor, _MOST_BINS)[1], along.means(values)[0]
        kinds = range(int(bins.max()) + 1) if len(bins) else ()
        at = tuple(float(along.places[bins == b].mean()) for b in kinds)
        means = tuple(_mean(y[bins == b]) for b in kinds)
        runs = np.bincount(bins[along.of_row], minlength=len(kinds))
        effects.append(MainEffect(factor.name, at, means, tuple(runs.tolist())))
    return tuple(effects)


def _mean(values: Floats) -> Interval:
    """With the interval of Student."""
    from scipy.special import stdtrit

    mean = float(values.mean())
    if len(values) < 2:
        return Interval(mean, math.nan, math.nan)
    half = stdtrit(len(values) - 1, 0.5 + CONFIDENCE / 2) * values.std(ddof=1) / math.sqrt(len(values))
    return Interval(mean, mean - float(half), mean + float(half))
