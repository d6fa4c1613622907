"""Limits on factors: what a box is made of."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from dse.analysis.data import Factor, Floats, Rows, StudyData


@dataclass(frozen=True, slots=True)
class Limit:
    """A factor's place is between *low* and *high*, NaN where it is not limited; or it is one of *levels*.

    Runs that lack the factor, as some do if it is *conditional*, keep to every limit.
    """

    factor: Factor
    low: float
    high: float
    levels: tuple[str, ...] = ()
    conditional: bool = False


def holds(limits: Iterable[Limit], data: StudyData) -> Rows:
    """Which runs keep to all of *limits*, (n,)."""
    inside = np.ones(len(data), dtype=np.bool_)
    for limit in limits:
        k = data.factor(limit.factor.name)
        inside &= _allowed(limit, data.factors[k], data.places[:, k])
    return inside


def looser(limit: Limit) -> list[tuple[Limit, ...]]:
    """With one of its bounds only, or not at all."""
    if np.isnan(limit.low) or np.isnan(limit.high):
        return [()]
    return [(replace(limit, high=np.nan),), (replace(limit, low=np.nan),)]


def _allowed(limit: Limit, factor: Factor, places: Floats) -> Rows:
    if factor.is_choice:
        found, where = np.unique(np.nan_to_num(places), return_inverse=True)
        allowed = np.array([factor.level(place) in limit.levels for place in found.tolist()], dtype=np.bool_)
        return np.asarray(allowed[where.reshape(-1)] & ~np.isnan(places), dtype=np.bool_)
    above = (places >= limit.low) | np.isnan(limit.low)
    below = (places <= limit.high) | np.isnan(limit.high)
    return np.asarray(above & below | np.isnan(places), dtype=np.bool_)
