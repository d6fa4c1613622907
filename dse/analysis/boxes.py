"""Where requirements are met, as boxes: limits on few factors that can be said in a sentence.

The patient rule induction method (Friedman and Fisher 1999): slices of a box are peeled off as long as that makes the
share of runs inside that pass larger, then limits are loosened again. What a box is worth is told by the half of the
runs that it was not made from; a box that they do not confirm is luck, and is not stated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dse.analysis.cells import effective
from dse.analysis.data import ALL, Factor, Floats, Rows, StudyData, withheld
from dse.analysis.limits import Limit, holds, looser
from dse.analysis.memoize import memoized
from dse.analysis.probability import Interval, wilson

LEAST = 60
"""Fewer runs than that are not split into two halves."""

_LEAST_PASSES = 10
_PEEL = 0.06
_LEAST_SUPPORT = 0.04
_LEAST_RUNS = 8
_PURE = 0.95
_MIXED = 0.75
_WORTH = 0.01
_LUCK = 0.001
_CHANCE = 0.05
_LEAST_COVERAGE = 0.1
_LEAST_DENSITY = 0.5
_DIGITS = 9


@dataclass(frozen=True, slots=True)
class Box:
    """Where all of *limits* hold, a requirement is met more often than elsewhere.

    *density* is the share of runs inside and in no earlier box that meet it, *coverage* the share of all runs that meet
    it that are there, both by *checked* runs there that the box was not made from. *luck* is how likely as many of them
    would pass anywhere.
    """

    limits: tuple[Limit, ...]
    density: Interval
    coverage: float
    luck: float
    checked: int

    def holds(self, data: StudyData) -> Rows:
        """Which runs are inside, (n,)."""
        return holds(self.limits, data)


@memoized
def best_boxes(data: StudyData, requirement: str = ALL, most: int = 3) -> tuple[Box, ...]:
    """The best box, then the best of what is outside of it, as long as that is worth it; none if all are luck.

    Runs that did not exercise a requirement, or failed to run, do not meet it. DseError if there are too few runs,
    fewer than ten that meet it, or hardly any others.
    """
    data = data.evenly(requirement, LEAST)
    met = data.met(requirement)
    if len(data) < LEAST:
        raise withheld(requirement, f"{len(data)} {data.rows} are too few for a box: {LEAST} are needed")
    if met.sum() < _LEAST_PASSES:
        raise withheld(
            requirement, f"{int(met.sum())} {data.rows} meet it, too few for a box: {_LEAST_PASSES} are needed"
        )
    if data.weights[met].sum() >= _PURE * data.weights.sum():
        raise withheld(
            requirement, f"nearly all {data.rows} meet it, {int(met.sum())} of {len(data)}: there is nothing to limit"
        )
    made = data.half()
    found: list[Box] = []
    left = np.ones(len(data), dtype=np.bool_)
    while len(found) < most and (met & made & left).sum() >= _LEAST_PASSES / 2:
        inside = _Inside(data.part(made & left), met[made & left])
        limits = inside.limits()
        limits = _confirmed(limits, data, met, left & ~made)
        box = _judged(limits, data, met, left & ~made, float(data.weights[met & ~made].sum()))
        if box is None or (found and (box.coverage < _LEAST_COVERAGE or box.density.value < _LEAST_DENSITY)):
            break
        found.append(box)
        left &= ~box.holds(data)
    return tuple(found)


class _Inside:
    """The runs a box is made from, and a box among them: lowest and highest places, and which levels are in."""

    def __init__(self, data: StudyData, met: Rows) -> None:
        self._data, self._met, self._w = data, met, data.weights
        self._columns = np.ascontiguousarray(data.places.T)
        count = len(data.factors)
        self._low, self._high = np.full(count, -np.inf), np.full(count, np.inf)
        self._out: list[frozenset[float]] = [frozenset()] * count

    def limits(self) -> tuple[Limit, ...]:
        """Peel, go back to the largest box that is about as pure as the purest, loosen."""
        trail = [self._box()]
        while self._peel():
            trail.append(self._box())
        worths = [self._density(self._rows(*box)) for box in trail]
        target = min(max(worths), _PURE)
        which = next(number for number, worth in enumerate(worths) if worth >= target - 1e-12)
        while which + 1 < len(trail) and self._added(trail[which], trail[which + 1]) < _MIXED * worths[which]:
            which += 1
        self._set(trail[which])
        self._loosen(target)
        return tuple(self._limit(k) for k in range(len(self._data.factors)) if self._is_limited(k))

    def _peel(self) -> bool:
        """Take off the slice that gains most for the runs it costs; False if none that leaves enough gains anything.

        A level of a choice costs many at once: what a number gains in as many steps counts as much (Kwakkel and
        Jaxa-Rozen 2016).
        """
        here = self._rows(*self._box())
        usual, count = self._density(here), int(here.sum())
        best, most = None, 0.0
        for k, factor in enumerate(self._data.factors):
            # A rule is advice: it names what the designer decides.
            x = self._columns[k][here if factor.is_decided else np.zeros_like(here)]
            x = x[~np.isnan(x)]
            if len(np.unique(x)) < 2:
                continue
            for box in self._peeled(k, factor, x):
                rows = self._rows(*box)
                left = int(rows.sum())
                if not max(_LEAST_SUPPORT * len(rows), _LEAST_RUNS) <= left < count:
                    continue
                # By few digits: the first of equals on every machine.
                gain = round((self._density(rows) - usual) / (count - left), _DIGITS)
                if gain > most:
                    best, most = box, gain
        if best is None:
            return False
        self._set(best)
        return True

    def _peeled(self, k: int, factor: Factor, x: Floats) -> list[_Sides]:
        low, high, out = self._box()
        if factor.is_choice:
            return [(low, high, [*out[:k], out[k] | {float(level)}, *out[k + 1 :]]) for level in np.unique(x).tolist()]
        values = np.unique(x)
        raised, lowered = low.copy(), high.copy()
        # The whole of the lowest level where there are few.
        raised[k] = values[max(int(np.searchsorted(values, np.quantile(x, _PEEL))), 1)]
        lowered[k] = values[
            min(int(np.searchsorted(values, np.quantile(x, 1 - _PEEL), side="right")) - 1, len(values) - 2)
        ]
        return [(raised, high, out), (low, lowered, out)]

    def _loosen(self, target: float) -> None:
        """Drop limits that do nothing for the share, least useful first, then widen the others step by step."""
        while True:
            looser = [box for k in range(len(self._data.factors)) if self._is_limited(k) for box in (self._without(k))]
            worths = [self._density(self._rows(*box)) for box in looser]
            if not worths or max(worths) < min(target, self._density(self._rows(*self._box()))) - _WORTH:
                break
            self._set(looser[int(np.argmax(np.round(worths, 9)))])
        while wider := [box for box in self._wider() if self._is_worth(box, target)]:
            self._set(max(wider, key=lambda box: int((self._rows(*box) & self._met).sum())))

    def _is_worth(self, box: _Sides, target: float) -> bool:
        return self._density(self._rows(*box)) >= target and self._added(box, self._box()) >= _MIXED * target

    def _added(self, box: _Sides, to: _Sides) -> float:
        """The density in what *box* has more than the one that it is added *to*."""
        return self._density(self._rows(*box) & ~self._rows(*to))

    def _without(self, k: int) -> list[_Sides]:
        low, high, out = self._box()
        free_low, free_high = low.copy(), high.copy()
        free_low[k], free_high[k] = -np.inf, np.inf
        free = [(free_low, high, out)] if np.isfinite(low[k]) else []
        free += [(low, free_high, out)] if np.isfinite(high[k]) else []
        return free + ([(low, high, [*out[:k], frozenset(), *out[k + 1 :]])] if out[k] else [])

    def _wider(self) -> list[_Sides]:
        """The box with one limit moved to where it holds a few runs more that pass."""
        low, high, out = self._box()
        here = self._rows(low, high, out)
        step = max(int(_PEEL * here.sum() / 2), 1)
        found: list[_Sides] = []
        for k in range(len(self._data.factors)):
            for side, sign in ((low, -1.0), (high, 1.0)):
                if not np.isfinite(side[k]):
                    continue
                free = [side.copy() if other is side else other for other in (low, high)]
                free[0 if side is low else 1][k] = sign * np.inf
                beyond = np.unique(self._data.places[self._rows(free[0], free[1], out) & ~here & self._met, k])
                if len(beyond):
                    place = beyond[min(step, len(beyond)) - 1] if sign > 0 else beyond[-min(step, len(beyond))]
                    free[0 if side is low else 1][k] = place
                    found.append((free[0], free[1], out))
        return found

    def _rows(self, low: Floats, high: Floats, out: list[frozenset[float]]) -> Rows:
        rows = np.ones(len(self._met), dtype=np.bool_)
        for k, levels in enumerate(out):
            # Whether a factor is there at all is for choices to say: what is no number is not outside.
            if low[k] > -np.inf:
                rows &= ~(self._columns[k] < low[k])
            if high[k] < np.inf:
                rows &= ~(self._columns[k] > high[k])
            if levels:
                rows &= ~np.isin(self._columns[k], [*levels])
        return rows

    def _density(self, rows: Rows) -> float:
        inside = self._w[rows].sum()
        return float(self._w[rows & self._met].sum() / inside) if inside else 0.0

    def _box(self) -> _Sides:
        return self._low, self._high, self._out

    def _set(self, box: _Sides) -> None:
        self._low, self._high, self._out = box

    def _is_limited(self, k: int) -> bool:
        return bool(np.isfinite(self._low[k]) or np.isfinite(self._high[k]) or self._out[k])

    def _limit(self, k: int) -> Limit:
        """With the bound in the middle between the last run inside and the next one outside."""
        factor, x = self._data.factors[k], np.unique(self._data.places[:, k])
        if factor.is_choice:
            inside = [value for value in x.tolist() if value not in self._out[k]]
            return Limit(factor, np.nan, np.nan, tuple(factor.level(value) for value in inside))
        low, high = float(self._low[k]), float(self._high[k])
        below, above = x[x < low], x[x > high]
        low = (low + float(below[-1])) / 2 if len(below) else low
        high = (high + float(above[0])) / 2 if len(above) else high
        is_conditional = bool(np.isnan(x).any())
        return Limit(factor, _end(low), _end(high), conditional=is_conditional)


_Sides = tuple[Floats, Floats, list[frozenset[float]]]


def _end(place: float) -> float:
    return place if np.isfinite(place) else np.nan


def _confirmed(limits: tuple[Limit, ...], data: StudyData, met: Rows, others: Rows) -> tuple[Limit, ...]:
    """Without the limits beyond which the *others* pass about as often as inside (Bryant and Lempert 2010)."""
    from scipy.special import bdtr

    whole = holds(limits, data) & others
    density = met[whole].mean() if whole.any() else 0.0
    while True:
        inside = holds(limits, data) & others
        best, least = limits, _CHANCE
        for number, limit in enumerate(limits):
            for freed in looser(limit):
                rest = (*limits[:number], *freed, *limits[number + 1 :])
                beyond = holds(rest, data) & others & ~inside
                chance = float(bdtr(int(met[beyond].sum()), int(beyond.sum()), density))
                if round(chance, 9) > least:
                    best, least = rest, round(chance, 9)
        if best is limits:
            return limits
        limits = best


def _judged(limits: tuple[Limit, ...], data: StudyData, met: Rows, others: Rows, passing: float) -> Box | None:
    """The box as the *others* see it, *passing* being the weight of all there are; None if it may be luck."""
    from scipy.special import bdtrc  # not scipy.stats, which takes a second to load

    box = Box(limits, Interval(0.0, 0.0, 0.0), 0.0, 1.0, 0)
    inside = box.holds(data) & others
    counts_as = effective(data.weights[inside])
    if not limits or not counts_as:
        return None
    density = float(data.weights[inside & met].sum() / data.weights[inside].sum())
    elsewhere = float(data.weights[others & met].sum() / data.weights[others].sum())
    tries = max(round(counts_as), 1)
    # As likely as this or more by chance (exact binomial test).
    luck = float(bdtrc(round(density * tries) - 1, tries, elsewhere))
    if luck > _LUCK:
        return None
    coverage = float(data.weights[inside & met].sum()) / passing
    return Box(limits, wilson(density * counts_as, counts_as), coverage, luck, int(inside.sum()))
