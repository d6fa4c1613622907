"""Numbers as sums over what is chosen, and comparisons of them as formulas.

Exact rewriting only: ``mean(p) <= c`` is ``sum(p - c) <= 0`` over what is there, ``sum(p) / sum(q) <= c`` is
``sum(p) - c * sum(q) <= 0`` where sum(q) is positive in every row, extremes against a number are about single parts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import ceil, floor, gcd, lcm

import numpy as np

from dse.errors import DseError
from dse.space.decisions import Site
from dse.space.flat import Ints
from dse.space.language.terms import ConditionalTerm, Constant, Entries, RollUp, Selected, Stated, Term, TermOperation
from dse.space.lowering.cells import scope_of_term, value_in_cells
from dse.space.lowering.formulas import (
    FALSE_FORMULA,
    TRUE_FORMULA,
    BoundedSum,
    Formula,
    conjoin,
    disjoin,
    literal,
    negation,
)
from dse.space.lowering.shape import SpaceShape, VariableValue

LARGEST_SUM = 2**62
"""Partial sums of weights stay below it."""

AffineWeights = dict[int, dict[int, Fraction]]
"""What each value of each variable contributes; nothing where it is not in it."""

OPPOSITE = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
"""The relation that holds exactly where the other does not."""

MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}
"""The relation that holds exactly where the other does with both sides negated."""


@dataclass(slots=True)
class Affine:
    """*constant* + *weights* + factor * term for each of *others*, defined where all of *there* hold."""

    constant: Fraction = Fraction(0)
    weights: AffineWeights = field(default_factory=dict)
    others: list[tuple[Fraction, Term]] = field(default_factory=list)
    there: list[Formula] = field(default_factory=list)

    def add(self, other: Affine, factor: Fraction) -> None:
        """Add *factor* times *other*."""
        self.constant += factor * other.constant
        for variable, values in other.weights.items():
            mine = self.weights.setdefault(variable, {})
            for value, weight in values.items():
                mine[value] = mine.get(value, Fraction(0)) + factor * weight
        self.others += [(factor * times, term) for times, term in other.others]
        self.there += other.there

    def times(self, factor: Fraction) -> Affine:
        """*factor* times this one."""
        found = Affine()
        found.add(self, factor)
        return found

    def is_number(self) -> bool:
        """Whether it is its constant, where it is defined."""
        return not self.weights and not self.others


def affine(shape: SpaceShape, term: Term) -> Affine:
    """*term*, a number, as a sum as far as it is one."""
    match term:
        case Constant(value):
            return Affine(Fraction(value))
        case Stated(entries):
            found = _weighted(entries)
            found.there.append(presence(shape, entries))
            return found
        case RollUp("sum", entries):
            return _weighted(entries)
        case RollUp("count", entries):
            return _weighted([(site, Fraction(1)) for site, _ in entries])
        case TermOperation("+" | "-" as sign, (left, right)):
            found = affine(shape, left)
            found.add(affine(shape, right), Fraction(1 if sign == "+" else -1))
            return found
        case TermOperation("negative", (operand,)):
            return affine(shape, operand).times(Fraction(-1))
        case ConditionalTerm(Selected(sites, named), yes, no) if None not in named:
            chosen, other = affine(shape, yes), affine(shape, no)
            if chosen.is_number() and other.is_number() and not (chosen.there or other.there):
                difference = chosen.constant - other.constant
                found = _weighted([(site, difference) for site in sites if site.name in named])
                found.constant += other.constant
                return found
        case TermOperation("*" | "/" as sign, (left, right)):
            scaled = _scaled(sign, affine(shape, left), affine(shape, right))
            if scaled is not None:
                return scaled
    return _tabulated(shape, term) or Affine(others=[(Fraction(1), term)])


def _tabulated(shape: SpaceShape, term: Term) -> Affine | None:
    """*term* where it looks at one variable and has a rational value whatever that is."""
    scope = scope_of_term(term)
    if len(scope) != 1:
        return None
    with suppress(DseError):
        *values, absent = value_in_cells(shape, term)
        base = Fraction(0) if shape.is_root(scope[0]) else absent
        if isinstance(base, Fraction) and all(isinstance(value, Fraction) for value in values):
            weights = {number: value - base for number, value in enumerate(values) if isinstance(value, Fraction)}
            return Affine(base, {scope[0]: weights})
    return None


def presence(shape: SpaceShape, entries: Entries) -> Formula:
    """That one of the sites is there."""
    branches = [site.branch for site, _ in entries]
    if None in branches or shape.is_certain(branch for branch in branches if branch):
        return TRUE_FORMULA
    return one_taken(shape, (branch for branch in branches if branch))


def one_taken(shape: SpaceShape, branches: Iterable[VariableValue]) -> Formula:
    """That one of *branches* is taken."""
    values: dict[int, list[int]] = {}
    for variable, value in branches:
        values.setdefault(variable, []).append(value)
    return disjoin(shape, [literal(shape, variable, shape.mask(variable, some)) for variable, some in values.items()])


def relation(shape: SpaceShape, number: Affine, operator: str) -> Formula | None:
    """Where ``number operator 0`` holds, *others* and *there* aside; None if the weights are too large."""
    if sum(weight for values in number.weights.values() for weight in values.values()) < 0:
        # The two ends of a range are bounds of one sum.
        number, operator = number.times(Fraction(-1)), MIRRORED[operator]
    sums = whole_sums(shape, number)
    if sums is None:
        return None
    weights, unit, constant = sums
    bound = -constant / unit
    match operator:
        case "<=":
            return between(shape, weights, None, floor(bound), unit)
        case "<":
            return between(shape, weights, None, ceil(bound) - 1, unit)
        case ">=":
            return between(shape, weights, ceil(bound), None, unit)
        case ">":
            return between(shape, weights, floor(bound) + 1, None, unit)
    equal = FALSE_FORMULA if bound.denominator != 1 else between(shape, weights, int(bound), int(bound), unit)
    return equal if operator == "==" else negation(shape, equal)


def whole_sums(shape: SpaceShape, number: Affine) -> tuple[dict[int, Ints], Fraction, Fraction] | None:
    """Weights in whole units, the unit, and the constant beside their sum; None if sums could reach `LARGEST_SUM`.

    The least weight of a variable that always exists is 0: what is there whatever is chosen is in the constant.
    """
    constant = number.constant
    shifted: AffineWeights = {}
    for variable, values in number.weights.items():
        least = Fraction(0)
        if shape.is_root(variable):
            least = min(values.get(value, Fraction(0)) for value in range(shape.widths[variable] - 1))
        constant += least
        stated = range(shape.widths[variable] - 1) if least else values
        weights = {value: values.get(value, Fraction(0)) - least for value in stated}
        if any(weights.values()):
            shifted[variable] = weights
    some = [weight for values in shifted.values() for weight in values.values() if weight]
    if not some:
        return {}, Fraction(1), constant
    unit = Fraction(gcd(*(weight.numerator for weight in some)), lcm(*(weight.denominator for weight in some)))
    if sum(max(map(abs, values.values())) for values in shifted.values()) / unit >= LARGEST_SUM:
        return None
    found: dict[int, Ints] = {}
    for variable, values in shifted.items():
        found[variable] = np.zeros(shape.widths[variable], np.int64)
        for value, weight in values.items():
            found[variable][value] = int(weight / unit)
    return found, unit, constant


def between(shape: SpaceShape, weights: dict[int, Ints], low: int | None, high: int | None, unit: Fraction) -> Formula:
    """That the sum lies between *low* and *high*; plainly true, false or a literal where it is."""
    least, most = reach(shape, weights)
    low = None if low is None or low <= least else low
    high = None if high is None or high >= most else high
    if low is None and high is None:
        return TRUE_FORMULA
    if (low is not None and low > most) or (high is not None and high < least):
        return FALSE_FORMULA
    if len(weights) == 1:
        ((variable, values),) = weights.items()
        mask = np.ones(len(values), bool)
        if low is not None:
            mask &= values >= low
        if high is not None:
            mask &= values <= high
        return literal(shape, variable, mask)
    return BoundedSum(weights, low, high, unit)


def reach(shape: SpaceShape, weights: Mapping[int, Ints]) -> tuple[int, int]:
    """The least and the greatest sum, each variable for itself."""
    least = most = 0
    for variable, values in weights.items():
        possible = values[:-1] if shape.is_root(variable) else values
        least += int(possible.min())
        most += int(possible.max())
    return least, most


def compare(shape: SpaceShape, term: TermOperation, outcome: bool) -> Formula | None:
    """Where the comparison *term* has the value *outcome*; None if that is no formula of sums and literals."""
    number = affine(shape, term.operands[0])
    number.add(affine(shape, term.operands[1]), Fraction(-1))
    operator = term.operator if outcome else OPPOSITE[term.operator]
    there = list(number.there)
    if number.others:
        if len(number.others) > 1 or number.weights or not number.others[0][0]:
            return None
        factor, other = number.others[0]
        against = -number.constant / factor
        operator = operator if factor > 0 else MIRRORED[operator]
        match other:
            case RollUp("min" | "max"):
                return conjoin(shape, [*there, _extreme(shape, other, operator, against)])
            case RollUp("mean", entries):
                number = _weighted([(site, value - against) for site, value in entries])
                if operator not in ("<", ">", "!="):
                    # The others fail anyway where the sum of nothing is 0.
                    there.append(presence(shape, entries))
            case TermOperation("/", (over, under)):
                ratio = _cross_multiplied(shape, over, under, against)
                if ratio is None:
                    return None
                number, positive = ratio
                there += number.there
                operator = operator if positive else MIRRORED[operator]
            case _:
                return None
    found = relation(shape, number, operator)
    return None if found is None else conjoin(shape, [*there, found])


def _weighted(entries: Iterable[tuple[Site, Fraction]]) -> Affine:
    found = Affine()
    for site, value in entries:
        branch = site.branch
        if branch is None:
            found.constant += value
        else:
            values = found.weights.setdefault(branch[0], {})
            values[branch[1]] = values.get(branch[1], Fraction(0)) + value
    return found


def _scaled(sign: str, left: Affine, right: Affine) -> Affine | None:
    if right.is_number() and not (sign == "/" and not right.constant):
        number, factor = left, 1 / right.constant if sign == "/" else right.constant
    elif sign == "*" and left.is_number():
        number, factor = right, left.constant
    else:
        return None
    return replace(number.times(factor), there=[*left.there, *right.there])


def _extreme(shape: SpaceShape, term: RollUp, operator: str, against: Fraction) -> Formula:
    """Where there is something and its least or greatest value is as *operator* says of *against*."""
    sign = 1 if term.function == "max" else -1
    operator = operator if sign == 1 else MIRRORED[operator]
    above = _holding(shape, term.entries, lambda value: sign * value > sign * against)
    reached = _holding(shape, term.entries, lambda value: sign * value >= sign * against)
    there = presence(shape, term.entries)
    match operator:
        case ">":
            return above
        case ">=":
            return reached
        case "<=":
            return conjoin(shape, [there, negation(shape, above)])
        case "<":
            return conjoin(shape, [there, negation(shape, reached)])
        case "==":
            return conjoin(shape, [reached, negation(shape, above)])
    return disjoin(shape, [above, conjoin(shape, [there, negation(shape, reached)])])


def _holding(shape: SpaceShape, entries: Entries, accepts: Callable[[Fraction], bool]) -> Formula:
    branches = [site.branch for site, value in entries if accepts(value)]
    return TRUE_FORMULA if None in branches else one_taken(shape, (branch for branch in branches if branch))


def _cross_multiplied(shape: SpaceShape, over: Term, under: Term, against: Fraction) -> tuple[Affine, bool] | None:
    """over - against * under, and whether *under* is positive in every row; None unless its sign is certain."""
    top, bottom = affine(shape, over), affine(shape, under)
    if top.others or bottom.others:
        return None
    least = most = bottom.constant
    for variable, values in bottom.weights.items():
        weights = list(values.values())
        if len(values) < shape.widths[variable] - int(shape.is_root(variable)):
            weights.append(Fraction(0))
        least += min(weights)
        most += max(weights)
    if least <= 0 <= most:
        return None
    top.add(bottom, -against)
    return top, least > 0
