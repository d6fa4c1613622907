"""The sums a design space speaks of, for whole blocks of rows: exact whole numbers, shown in a unit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.design import DesignSpace
from dse.domain.expression import ROLLUPS, Call, Expression, Name
from dse.expression import descend
from dse.space.decisions import Site, sites
from dse.space.flat import Bools, Floats, Ints, Rows
from dse.space.lowering.shape import shape_of
from dse.units import Quantity, Unit

_EXACT = 2**53
_LARGEST = 2**62


@dataclass(frozen=True, slots=True, eq=False)
class PropertySum:
    """The sum of property *name* over all parts that state it.

    It is *start* and the weights of what is chosen, one of which stands for *scale* in SI: arrays of shape
    (values + 1,), of Python integers where 64 bits are too few. *stated* and *always* count the parts in the same way.
    """

    name: str
    unit: Unit
    scale: Fraction
    start: int
    weights: Mapping[int, NDArray[Any]]
    always: int
    stated: Mapping[int, Ints]

    @property
    def heading(self) -> str:
        """The name of its column: ``sum(cost) [EUR]``."""
        return f"sum({self.name}) [{str(self.unit) or '1'}]"

    @property
    def is_small(self) -> bool:
        """Whether all sums fit 64 bits."""
        return all(array.dtype == np.int64 for array in self.weights.values())

    def sums(self, rows: Rows) -> NDArray[Any]:
        """The sum of each row in whole multiples of *scale*; 0 where no part states the property."""
        total = np.full(len(rows), self.start, np.int64 if self.is_small else object)
        for variable, values in self.weights.items():
            total += values[rows[:, variable]]
        return total

    def there(self, rows: Rows) -> Bools:
        """Whether any part of each row states the property."""
        number = np.full(len(rows), self.always, np.int64)
        for variable, values in self.stated.items():
            number += values[rows[:, variable]]
        return number > 0

    def values(self, rows: Rows) -> Floats:
        """The sum of each row in *unit*, correctly rounded; NaN where no part states the property."""
        sums = self.sums(rows)
        ratio = self.scale / self.unit.factor
        if self.unit.offset == 0 and ratio.denominator < _EXACT and self._fits(sums, ratio.numerator):
            shown: Floats = (sums * ratio.numerator) / np.float64(ratio.denominator)
        else:
            unique, places = np.unique(sums, return_inverse=True)
            shown = np.array([self.shown(int(number)) for number in unique.tolist()], np.float64)[places]
        return np.where(self.there(rows), shown, np.nan)

    def shown(self, number: int) -> float:
        """A sum in whole multiples of *scale* as a number in *unit*; infinite beyond the range of floats."""
        value = (number * self.scale - self.unit.offset) / self.unit.factor
        try:
            return float(value)
        except OverflowError:
            return math.inf if value > 0 else -math.inf

    def _fits(self, sums: NDArray[Any], factor: int) -> bool:
        """Whether sums times *factor* are exact as floating-point numbers."""
        return self.is_small and int(np.abs(sums).max(initial=0)) * abs(factor) < _EXACT


def property_sums(space: DesignSpace, also: Iterable[str] = ()) -> tuple[PropertySum, ...]:
    """The sums that the constraints of *space* speak of, and of what is asked for *also*.

    Each is in the unit that the first component gives it in.
    """
    lengths = [len(variable.values) + 1 for variable in shape_of(space).variables]
    there = sites(space)
    found = []
    for name in dict.fromkeys((*summed_properties(space), *also)):
        entries = [(site, site.component.properties[name]) for site in there if site.component and _states(site, name)]
        if entries:
            found.append(_property_sum(name, lengths, entries))
    return tuple(found)


def summed_properties(space: DesignSpace) -> tuple[str, ...]:
    """Names of the properties that the constraints of *space* add up, in their order; a bare ``cost`` adds up, too.

    Others, a range or a field of view, would make no sense as a sum.
    """
    names: dict[str, None] = {}
    for constraint in space.constraints:
        names.update(dict.fromkeys(_summed(constraint.rule)))
    return tuple(names)


def _summed(expression: Expression) -> list[str]:
    names: list[str] = []
    rolled: set[int] = set()
    for node in descend(expression.root):
        match node:
            case Call("same_choice", arguments=arguments):
                rolled.update(map(id, arguments))
            case Call(function, arguments=(Name(path) as first, *_)) if function in ROLLUPS and "." not in path:
                rolled.update(map(id, node.arguments))
                if function == "sum":
                    names.append(first.path)
            case Name(path) if "." not in path and id(node) not in rolled:
                names.append(path)
    return names


def _states(site: Site, name: str) -> bool:
    return site.component is not None and name in site.component.properties


def _property_sum(name: str, lengths: Sequence[int], entries: Sequence[tuple[Site, Quantity]]) -> PropertySum:
    numbers = [quantity.si for _, quantity in entries if quantity.si]
    scale = Fraction(1)
    if numbers:
        scale = Fraction(math.gcd(*(n.numerator for n in numbers)), math.lcm(*(n.denominator for n in numbers)))
    fits = sum(abs(number) for number in numbers) / scale < _LARGEST
    weights: dict[int, NDArray[Any]] = {}
    stated: dict[int, Ints] = {}
    start = always = 0
    for site, quantity in entries:
        whole = int(quantity.si / scale)
        if site.branch is None:
            start, always = start + whole, always + 1
            continue
        variable, value = site.branch
        if variable not in weights:
            weights[variable] = np.zeros(lengths[variable], np.int64 if fits else object)
            stated[variable] = np.zeros(lengths[variable], np.int64)
        weights[variable][value] += whole
        stated[variable][value] += 1
    return PropertySum(name, entries[0][1].unit, scale, start, weights, always, stated)
