"""The best rows under a nonlinear objective: branch and bound over regions of what it is calculated from.

A region bounds every fold of the objective. Lagrangian bounds narrow it, the ends of the objective over it say
whether it can matter, a beam finds good rows in it. It is searched completely if that is little work, and else parted
in two; the most promising region is the next (Land and Doig, 1960, best bound first).

Example: the least cost / range, with cost in 2 .. 6 and range in 1 .. 3; a beam finds a row of 1.

    all of it: at least 2 / 3, so it may hold a better row, and is parted by the cost
    cost 4 .. 6: at least 4 / 3, worse than 1, is dropped without a search
    cost 2 .. 3: at least 2 / 3, is searched

Cost: regions, each with Lagrangian bounds of its folds and up to 24 pieces of search. Beyond the allowance of work the
question is refused (docs/decisions/0007-design-space-engine.md).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from heapq import heappop, heappush
from math import inf, nextafter
from typing import Protocol

import numpy as np

from dse.space.flat import NO_VALUE, Bools, Floats, Fold, Gather, Ints, Linear, Rows, Wide
from dse.space.methods.budget import TooMuchError
from dse.space.methods.listing.bounds import fits
from dse.space.methods.listing.walk import Rounds
from dse.space.methods.mdd.diagram import DecisionDiagram, restrict
from dse.space.methods.mdd.folds import fold_rows, interval, rests
from dse.space.methods.optimum.optimizer import Optimizer, RankedRows

_TRIAL = 24
"""Rounds that a region is searched for before it is parted."""

_DIGITS = 1000
"""What the steepest slope of the objective is rounded to."""

Ends = tuple[int, int]


class Valued(Protocol):
    """A nonlinear objective over folds that 64 bits hold."""

    @property
    def folds(self) -> tuple[Fold, ...]:
        """What it is calculated from."""

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Floats, Floats]:
        """Ends between which the value surely lies for folds in [low, high]: rounded outwards, infinite if unknown."""

    def value(self, folds: Sequence[int]) -> Fraction | None:
        """The exact value; None where it is undefined, and such rows are not ranked."""


@dataclass(frozen=True, slots=True, eq=False)
class _Region:
    """Rows whose folds lie in *ends*; *optimizer* has, for each summed fold, it and its negative as objectives."""

    optimizer: Optimizer
    ends: tuple[Ends, ...]


def best_valued(
    diagram: DecisionDiagram, objective: Valued, number: int, *, largest: bool = False, most_rounds: int | None = None
) -> RankedRows:
    """The *number* valid rows of least (or largest) defined value, or all if there are fewer.

    Of equal rows those come first that the list has first. Raises TooMuchError if what is best is not proven after
    *most_rounds* pieces of work of `DiagramWalk`.
    """
    if number < 1 or diagram.empty:
        return RankedRows(np.zeros((0, len(diagram.order)), np.int16), ())
    search = _Search(diagram, objective, number, largest, None if most_rounds is None else Rounds(most_rounds))
    ranked = search.ranked()
    rows = np.array([row for _, row in ranked], np.int16).reshape(len(ranked), len(diagram.order))
    return RankedRows(rows, tuple(-value if largest else value for value, _ in ranked))


class _Search:
    """The state of a branch and bound; values are negated if the largest is wanted."""

    def __init__(
        self, diagram: DecisionDiagram, objective: Valued, number: int, largest: bool, rounds: Rounds | None
    ) -> None:
        self.diagram = diagram
        self.objective = objective
        self.number = number
        self.largest = largest
        self.rounds = rounds
        self.sums = [place for place, fold in enumerate(objective.folds) if _is_sum(fold)]
        self.found: dict[tuple[int, ...], Fraction] = {}
        self.limit: Fraction | None = None
        self._key = np.array(diagram.order, np.intp)

    def ranked(self) -> list[tuple[Fraction, tuple[int, ...]]]:
        """The values and rows that are best, in order."""
        best: list[tuple[Fraction, tuple[int, ...]]] = []
        serial = 0
        heap = [(-inf, serial, self._root())]
        while heap:
            bound, _, region = heappop(heap)
            if self._is_beaten(bound):
                break
            narrowed = self._narrowed(region)
            if narrowed is None or self._is_beaten(self._bound(narrowed)):
                continue
            self._note(self._promising(narrowed))
            parts = self._parts(narrowed)
            try:
                best += self._searched(narrowed, final=not parts)
            except TooMuchError:
                if not parts or (self.rounds is not None and not self.rounds.left):
                    raise
                for part in parts:
                    serial += 1
                    heappush(heap, (self._bound(part), serial, part))
                continue
            best = sorted(best, key=self._place)[: self.number]
        return best

    def _root(self) -> _Region:
        start = np.zeros(1, np.int32)
        ends = []
        for fold in self.objective.folds:
            low, high = interval(fold.gather, np.full(1, fold.start), rests(self.diagram, fold)[0], start)
            ends.append((int(low[0]), int(high[0])))
        return _Region(self._optimizer(self.diagram), tuple(ends))

    def _optimizer(self, diagram: DecisionDiagram) -> Optimizer:
        weights = [self.objective.folds[place].values for place in self.sums]
        both = ((values, {variable: -part for variable, part in values.items()}) for values in weights)
        return Optimizer(diagram, [side for pair in both for side in pair])

    def _narrowed(self, region: _Region) -> _Region | None:
        """With ends no further than the Lagrangian bounds; None if nothing is left."""
        optimizer = region.optimizer
        if optimizer.diagram.empty:
            return None
        ends = list(region.ends)
        for number, place in enumerate(self.sums):
            start = self.objective.folds[place].start
            highs = self._highs(ends)
            low, high = ends[place]
            low = max(low, start + optimizer.least(2 * number, highs))
            high = min(high, start - optimizer.least(2 * number + 1, highs))
            if low > high:
                return None
            ends[place] = (low, high)
        return replace(region, ends=tuple(ends))

    def _highs(self, ends: Sequence[Ends]) -> list[int | None]:
        highs: list[int | None] = []
        for place in self.sums:
            start = self.objective.folds[place].start
            highs += [ends[place][1] - start, start - ends[place][0]]
        return highs

    def _bound(self, region: _Region) -> float:
        """What the objective is at least in the region."""
        return self._ends(region.ends)[0]

    def _ends(self, ends: Sequence[Ends]) -> tuple[float, float]:
        low, high = ([np.array([end[side]], np.int64) for end in ends] for side in (0, 1))
        below, above = (float(np.ravel(part)[0]) for part in self.objective.bounds(low, high))
        return (-above, -below) if self.largest else (below, above)

    def _is_beaten(self, bound: float) -> bool:
        return self.limit is not None and bound > self.limit

    def _promising(self, region: _Region) -> Rows:
        """Rows that are good in the direction in which the objective falls from the middle of the region."""
        middle = [((low + high) // 2,) * 2 for low, high in region.ends]
        slopes = []
        for place in self.sums:
            low, high = region.ends[place]
            at = [self._ends([*middle[:place], (end, end), *middle[place + 1 :]])[0] for end in (low, high)]
            slopes.append((at[1] - at[0]) / max(high - low, 1) if np.isfinite(at).all() else 0.0)
        steepest = max(map(abs, slopes), default=0.0) or 1.0
        factors = [factor for slope in slopes for factor in (round(slope / steepest * _DIGITS), 0)]
        return region.optimizer.some(factors, self._highs(region.ends))

    def _note(self, rows: Rows) -> None:
        """Remember the values of valid rows: what is worse than enough of them is not wanted."""
        for row, value in zip(map(tuple, rows.tolist()), self._values(rows), strict=True):
            if value is not None:
                self.found[row] = value
        if len(self.found) >= self.number:
            self.found = dict(sorted(self.found.items(), key=lambda item: item[1])[: self.number])
            self.limit = max(self.found.values())

    def _values(self, rows: Rows) -> list[Fraction | None]:
        columns = [fold_rows(fold, rows).tolist() for fold in self.objective.folds]
        known: dict[tuple[int, ...], Fraction | None] = {}
        values = []
        for folds in zip(*columns, strict=True) if columns else [()] * len(rows):
            if folds not in known:
                known[folds] = self.objective.value(folds)
            value = known[folds]
            values.append(-value if value is not None and self.largest else value)
        return values

    def _searched(self, region: _Region, *, final: bool) -> list[tuple[Fraction, tuple[int, ...]]]:
        """The best rows of a region, as far as they matter. Raises TooMuchError, sooner if it is not *final*."""
        judge = _Better(self, region.ends)
        wides = [Wide(self.objective.folds, judge)]
        rounds = self.rounds
        if not final:
            rounds = Rounds(_TRIAL if rounds is None else min(_TRIAL, rounds.left))
        granted = rounds.left if rounds is not None else 0
        best: list[tuple[Fraction, tuple[int, ...]]] = []
        listing = region.optimizer.listing(self._highs(region.ends), wides, rounds)
        try:
            for block in listing if listing is not None else ():
                values = self._values(block)
                rows = map(tuple, block.tolist())
                best += [(value, row) for value, row in zip(values, rows, strict=True) if value is not None]
                best = sorted(best, key=self._place)[: self.number]
                self._note(block)
                if len(best) == self.number:
                    # Within one list later rows of the same value are no better.
                    judge.below = best[-1][0]
        finally:
            if rounds is not None and self.rounds is not None and rounds is not self.rounds:
                self.rounds.left -= granted - rounds.left
        return best

    def _place(self, ranked: tuple[Fraction, tuple[int, ...]]) -> tuple[Fraction, list[int]]:
        """By value, then as in the list: whether a decision is `ABSENT` is settled by those before it."""
        return ranked[0], np.array(ranked[1])[self._key].tolist()

    def _parts(self, region: _Region) -> list[_Region]:
        """The region in two: where the objective then differs most; none if all folds are given."""
        candidates = []
        for place, (low, high) in enumerate(region.ends):
            split = self._split(place, low, high)
            if split is not None:
                halves = [(low, split), (split + 1, high)]
                ends = [(*region.ends[:place], half, *region.ends[place + 1 :]) for half in halves]
                bounds = [self._ends(part)[0] for part in ends]
                # What the worse half can be left out with counts first, then the width.
                candidates.append((max(bounds), min(bounds), high - low, place, ends))
        if not candidates:
            return []
        *_, place, ends = max(candidates, key=lambda candidate: candidate[:3])
        return [self._part(region, place, part) for part in ends]

    def _split(self, place: int, low: int, high: int) -> int | None:
        """The greatest value of the lower half of a fold."""
        fold = self.objective.folds[place]
        if low >= high or fold.gather is Gather.PRODUCT or (fold.gather is Gather.SUM and place not in self.sums):
            return None
        if fold.gather is Gather.SUM:
            return (low + high) // 2
        entries = np.unique(np.concatenate([np.array([fold.start]), *fold.values.values()]))
        within = entries[(entries >= low) & (entries <= high)]
        return int(within[(len(within) - 1) // 2]) if len(within) > 1 else None

    def _part(self, region: _Region, place: int, ends: tuple[Ends, ...]) -> _Region:
        fold = self.objective.folds[place]
        if fold.gather is Gather.SUM:
            return replace(region, ends=ends)
        masks = _masks(fold, *ends[place])
        diagram = restrict(region.optimizer.diagram, masks) if masks else region.optimizer.diagram
        return _Region(self._optimizer(diagram), ends)


class _Better:
    """Holds for rows within *ends* that are no worse than what is known, and better than *below*, which goes down."""

    def __init__(self, search: _Search, ends: Sequence[Ends]) -> None:
        self.search = search
        self.ends = ends
        self.below: Fraction | None = None

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Bools, Bools]:
        inside = np.ones(len(low[0]) if low else 1, np.bool_)
        # What a partial row could reach by itself, other bounds of the region may forbid.
        low = [np.maximum(part, end[0]) for part, end in zip(low, self.ends, strict=True)]
        high = [np.minimum(part, end[1]) for part, end in zip(high, self.ends, strict=True)]
        for below, above in zip(low, high, strict=True):
            inside &= below <= above
        low = [np.where(inside, part, end[0]) for part, end in zip(low, self.ends, strict=True)]
        high = [np.where(inside, part, end[1]) for part, end in zip(high, self.ends, strict=True)]
        if all(least == most for least, most in self.ends):
            # Ends that are rounded outwards do not tell what is as good as the best from what is better.
            return inside & self.holds([least for least, _ in self.ends]), inside
        ends = self.search.objective.bounds(low, high)
        least = -ends[1] if self.search.largest else ends[0]
        may_hold = inside
        if self.search.limit is not None:
            may_hold = may_hold & (least < _above(self.search.limit, itself=False))
        if self.below is not None:
            may_hold = may_hold & (least < _above(self.below, itself=True))
        return may_hold, np.ones_like(may_hold)

    def holds(self, folds: Sequence[int]) -> bool:
        if not all(low <= fold <= high for fold, (low, high) in zip(folds, self.ends, strict=False)):
            return False
        value = self.search.objective.value(folds)
        if value is None:
            return False
        value = -value if self.search.largest else value
        return (self.search.limit is None or value <= self.search.limit) and (self.below is None or value < self.below)


def _above(value: Fraction, *, itself: bool) -> float:
    """The least float above *value*, or *itself* if it is one."""
    near = float(value)
    return near if near > value or (itself and near == value) else nextafter(near, inf)


def _is_sum(fold: Fold) -> bool:
    return fold.gather is Gather.SUM and fits(Linear(fold.values, fold.start, fold.start))


def _masks(fold: Fold, low: int, high: int) -> Mapping[int, Bools]:
    """The values that no row can take whose fold is a least or greatest entry within the ends."""
    if fold.gather is Gather.MIN:
        return {variable: values >= low for variable, values in fold.values.items()}
    return {variable: (values <= high) | (values == NO_VALUE) for variable, values in fold.values.items()}
