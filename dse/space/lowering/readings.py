"""The leaves of a term as folds over what is chosen, and how their values are read from the folds.

A value of a place is the sum of what its alternatives contribute, of which one is there; extremes are folds of the
ranks of the values, so that no number is too long for 64 bits. Numbers that are, are summed digit by digit.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from math import gcd, lcm, prod
from typing import Protocol, TypeVar

import numpy as np

from dse.space.decisions import Site
from dse.space.flat import NO_VALUE, Floats, Gather, Ints
from dse.space.language.arithmetic import ExactValue
from dse.space.language.intervals import NumberBounds, TruthBounds, calculation, defined_between, ends, scaled
from dse.space.language.terms import Entries, Leaf, RollUp, Selected, Stated
from dse.space.lowering.folds import Folds

_T = TypeVar("_T")
_LARGEST = 2**62
_BITS = 30


class Reading(Protocol):
    """A leaf, read from folds."""

    def value(self, folds: Sequence[int]) -> ExactValue:
        """The exact value, None where it is undefined."""

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> NumberBounds | TruthBounds:
        """What it may be for folds between *low* and *high*, arrays of one shape."""


def reading(leaf: Leaf, folds: Folds) -> Reading:
    """How *leaf* is read; what it needs is added to *folds*."""
    match leaf:
        case Selected():
            return _standing(leaf, folds)
        case Stated(entries):
            return _stated(entries, folds)
        case RollUp("sum", entries):
            return _sum(entries, folds)
        case RollUp("count", entries):
            return _sum([(site, Fraction(1)) for site, _ in entries], folds)
        case RollUp("mean", entries):
            count = folds.total((site, 1) for site, _ in entries)
            return _Mean(_sum(entries, folds), count, *_range(entries))
        case RollUp("product", entries):
            return _product(entries, folds)
        case RollUp(function, entries):
            values = sorted({value for _, value in entries})
            rank = {value: number for number, value in enumerate(values)}
            gather = Gather.MIN if function == "min" else Gather.MAX
            fold = folds.extreme(gather, ((site, rank[value]) for site, value in entries))
            both = [ends(value) for value in values]
            return _Extreme(fold, tuple(values), np.array([a for a, _ in both]), np.array([b for _, b in both]))


@dataclass(frozen=True, slots=True, eq=False)
class _Sum:
    """The folds *parts*, each times its scale."""

    parts: tuple[tuple[int, Fraction], ...]

    def value(self, folds: Sequence[int]) -> Fraction:
        return sum((folds[fold] * scale for fold, scale in self.parts), Fraction(0))

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> NumberBounds:
        parts = [defined_between(*scaled(low[fold], high[fold], scale)) for fold, scale in self.parts]
        return reduce(lambda total, part: calculation("+", [total, part]), parts)


@dataclass(frozen=True, slots=True, eq=False)
class _Stated:
    """A sum of which one part is there if the fold *presence* is 1; None if it is always."""

    sum: _Sum
    presence: int | None
    least: float
    most: float

    def value(self, folds: Sequence[int]) -> Fraction | None:
        return None if self.presence is not None and folds[self.presence] < 1 else self.sum.value(folds)

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> NumberBounds:
        found = self.sum.bounds(low, high)
        yes, no = found.defined, found.undefined
        defined = yes if self.presence is None else high[self.presence] >= 1
        undefined = no if self.presence is None else low[self.presence] < 1
        # The sum of nothing is 0, which need not be among the values.
        least = np.clip(found.low, self.least, self.most)
        return NumberBounds(least, np.clip(found.high, self.least, self.most), defined, undefined, no)


@dataclass(frozen=True, slots=True, eq=False)
class _Mean:
    sum: _Sum
    count: int
    least: float
    most: float

    def value(self, folds: Sequence[int]) -> Fraction | None:
        return self.sum.value(folds) / folds[self.count] if folds[self.count] else None

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> NumberBounds:
        fewest, most = np.maximum(low[self.count], 1), np.maximum(high[self.count], 1)
        count = defined_between(fewest.astype(float), most.astype(float))
        mean = calculation("/", [self.sum.bounds(low, high), count])
        defined, undefined = high[self.count] >= 1, low[self.count] < 1
        least = np.clip(mean.low, self.least, self.most)
        return NumberBounds(least, np.clip(mean.high, self.least, self.most), defined, undefined, mean.fails)


@dataclass(frozen=True, slots=True, eq=False)
class _Extreme:
    """A fold of ranks among *values*; *low* and *high* are floats around them."""

    fold: int
    values: tuple[Fraction, ...]
    low: Floats
    high: Floats

    def value(self, folds: Sequence[int]) -> Fraction | None:
        rank = folds[self.fold]
        return None if rank == NO_VALUE else self.values[rank]

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> NumberBounds:
        last = len(self.values) - 1
        least, most = low[self.fold], high[self.fold]
        return NumberBounds(
            self.low[np.clip(least, 0, last)],
            self.high[np.clip(most, 0, last)],
            least != NO_VALUE,
            most == NO_VALUE,
            np.zeros(least.shape, bool),
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Product:
    """A fold of numerators, of magnitude *largest* at most, over denominator^(how many there are)."""

    fold: int
    count: int
    denominator: int
    largest: int

    def value(self, folds: Sequence[int]) -> Fraction:
        if folds[self.fold] == NO_VALUE:
            return Fraction(1)
        return Fraction(folds[self.fold], self.denominator ** folds[self.count])

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> NumberBounds:
        least, most = low[self.fold], high[self.fold]
        # What may be nothing may be 1.
        top_low = np.where(most == NO_VALUE, np.minimum(least, 1), least)
        top_high = np.where(most == NO_VALUE, np.where(least == NO_VALUE, 1, self.largest), most)
        base = np.full(least.shape, float(self.denominator))
        top = defined_between(*scaled(top_low, top_high, Fraction(1)))
        return calculation("/", [top, _raised(defined_between(base, base), low[self.count], high[self.count])])


@dataclass(frozen=True, slots=True, eq=False)
class _Powers:
    """The product of value^fold over distinct values."""

    parts: tuple[tuple[Fraction, int], ...]

    def value(self, folds: Sequence[int]) -> Fraction:
        found = Fraction(1)
        for value, fold in self.parts:
            found *= value ** folds[fold]
        return found

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> NumberBounds:
        shape = low[self.parts[0][1]].shape
        found = defined_between(np.ones(shape), np.ones(shape))
        for value, fold in self.parts:
            below, above = ends(value)
            base = defined_between(np.full(shape, below), np.full(shape, above))
            found = calculation("*", [found, _raised(base, low[fold], high[fold])])
        return found


@dataclass(frozen=True, slots=True, eq=False)
class _Standing:
    fold: int

    def value(self, folds: Sequence[int]) -> bool:
        return folds[self.fold] >= 1

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> TruthBounds:
        no = np.zeros(low[self.fold].shape, bool)
        return TruthBounds(high[self.fold] >= 1, low[self.fold] < 1, no, no)


def _standing(leaf: Selected, folds: Folds) -> _Standing:
    named = [(site, 1) for site in leaf.sites if site.name in leaf.named]
    if None not in leaf.named:
        return _Standing(folds.total(named))
    others = ((site, -1) for site in leaf.sites if site.name not in leaf.named)
    return _Standing(folds.total(others, start=1))


def _stated(entries: Entries, folds: Folds) -> _Stated:
    branches = [site.branch for site, _ in entries]
    always = None in branches or folds.shape.is_certain(branch for branch in branches if branch)
    presence = None if always else folds.total((site, 1) for site, _ in entries)
    return _Stated(_sum(entries, folds), presence, *_range(entries))


def _sum(entries: Sequence[tuple[Site, Fraction]], folds: Folds) -> _Sum:
    values = [value for _, value in entries if value]
    if not values:
        return _Sum(((folds.total([]), Fraction(1)),))
    unit = Fraction(gcd(*(value.numerator for value in values)), lcm(*(value.denominator for value in values)))
    units = [(site, int(value / unit)) for site, value in entries]
    if sum(abs(value) for _, value in units) < _LARGEST:
        return _Sum(((folds.total(units, unit), unit),))
    digits = -(-max(abs(value) for _, value in units).bit_length() // _BITS)
    parts = []
    for number in range(digits):
        scale = unit * (1 << (_BITS * number))
        parts.append((folds.total([(site, _digit(value, number)) for site, value in units], scale), scale))
    return _Sum(tuple(parts))


def _digit(value: int, number: int) -> int:
    part = (abs(value) >> (_BITS * number)) & ((1 << _BITS) - 1)
    return part if value >= 0 else -part


def _product(entries: Entries, folds: Folds) -> _Product | _Powers:
    denominator = lcm(*(value.denominator for _, value in entries))
    units = [(site, int(value * denominator)) for site, value in entries]
    largest = _largest_product(units)
    if largest < _LARGEST:
        count = folds.total(((site, 1) for site, _ in entries) if denominator > 1 else ())
        return _Product(folds.extreme(Gather.PRODUCT, units), count, denominator, largest)
    groups: dict[Fraction, list[tuple[Site, int]]] = {}
    for site, value in entries:
        groups.setdefault(value, []).append((site, 1))
    return _Powers(tuple((value, folds.total(group)) for value, group in groups.items()))


def _largest_product(units: Iterable[tuple[Site, int]]) -> int:
    sizes: dict[int | None, dict[int, int]] = {}
    for site, value in units:
        variable, number = site.branch or (None, 0)
        branches = sizes.setdefault(variable, {})
        branches[number] = branches.get(number, 1) * max(1, abs(value))
    return prod(max(branches.values()) for branches in sizes.values())


def _raised(base: NumberBounds, low: Ints, high: Ints) -> NumberBounds:
    """base^n for whole n >= 0 between *low* and *high*."""
    found = []
    for exponent in (low, high):
        number = np.maximum(exponent, 0).astype(float)
        largest = np.maximum(np.abs(base.low), np.abs(base.high)) ** number
        smallest = np.minimum(np.abs(base.low), np.abs(base.high)) ** number
        found += [largest, smallest]
    with np.errstate(over="ignore"):
        most, least = np.maximum.reduce(found), np.minimum.reduce(found)
    # What is not positive swings between its signs, and is 0 or 1 for 0.
    swings = base.low <= 0
    below = np.where(swings, -np.maximum(most, 1.0), least) * (1 - 1e-13 * np.where(swings, -1, 1))
    return defined_between(below, np.maximum(np.where(swings, np.maximum(most, 1.0), most), 1e-290) * (1 + 1e-13))


def _range(entries: Entries) -> tuple[float, float]:
    values = [value for _, value in entries]
    return ends(min(values))[0], ends(max(values))[1]
