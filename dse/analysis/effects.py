"""What a metric does as a factor changes: means along it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dse.analysis.bins import binned
from dse.analysis.data import StudyData
from dse.analysis.first_order import inseparable
from dse.analysis.probability import CONFIDENCE, Interval

if TYPE_CHECKING:
    from dse.analysis.data import Floats

_MOST_BINS = 8
_LEAST, _LEAST_EVEN = 4, 40


@dataclass(frozen=True, slots=True)
class MainEffect:
    """The mean of a metric (SI) along a *factor*, bin by bin: *at* are the mean places, *runs* how many there are.

    A bin of one run has a mean without an interval: NaN.
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
        rows, bins = binned(there.places[:, k], factor, _MOST_BINS)
        kinds = range(int(bins.max()) + 1) if len(bins) else ()
        inside = [values[rows][bins == b] for b in kinds]
        at = tuple(float(there.places[rows, k][bins == b].mean()) for b in kinds)
        effects.append(MainEffect(factor.name, at, tuple(map(_mean, inside)), tuple(map(len, inside))))
    return tuple(effects)


def _mean(values: Floats) -> Interval:
    """With the interval of Student."""
    from scipy.special import stdtrit

    mean = float(values.mean())
    if len(values) < 2:
        return Interval(mean, math.nan, math.nan)
    half = stdtrit(len(values) - 1, 0.5 + CONFIDENCE / 2) * values.std(ddof=1) / math.sqrt(len(values))
    return Interval(mean, mean - float(half), mean + float(half))
