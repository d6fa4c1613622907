"""Three-valued interval arithmetic over arrays: what a value may be when its parts lie between bounds.

Ends are floats rounded outward, so that the exact value, and the float that stands for a root, lies between them
(Moore, Interval Analysis, 1966). Never wrong, but vague where a value may not exist.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

import numpy as np

from dse.expression import COMPARISON_OPERATORS
from dse.space.flat import Bools, Floats, Ints

_TINY = 1e-290
_SLACK = 2.0**-49
_LARGEST_POWER = 64
"""Higher ones are taken for vague: their digits may be too many."""


@dataclass(frozen=True, slots=True, eq=False)
class NumberBounds:
    """Numbers between *low* and *high*; whether they may be defined, may be undefined, and may fail to exist."""

    low: Floats
    high: Floats
    defined: Bools
    undefined: Bools
    fails: Bools


@dataclass(frozen=True, slots=True, eq=False)
class TruthBounds:
    """What a condition may be, and whether it may fail."""

    true: Bools
    false: Bools
    undefined: Bools
    fails: Bools


def known(value: Fraction | float, form: tuple[int, ...]) -> NumberBounds:
    """The same number everywhere."""
    low, high = ends(value)
    yes, no = np.ones(form, bool), np.zeros(form, bool)
    return NumberBounds(np.full(form, low), np.full(form, high), yes, no, no)


def certain(value: bool, form: tuple[int, ...]) -> TruthBounds:
    """The same truth everywhere."""
    yes, no = np.ones(form, bool), np.zeros(form, bool)
    return TruthBounds(yes if value else no, no if value else yes, no, no)


def defined_between(low: Floats, high: Floats) -> NumberBounds:
    """Numbers between *low* and *high*, all defined."""
    yes, no = np.ones(low.shape, bool), np.zeros(low.shape, bool)
    return NumberBounds(low, high, yes, no, no)


def ends(value: Fraction | float) -> tuple[float, float]:
    """Floats around an exact number; the number itself if it is one."""
    try:
        near = float(value)
    except OverflowError:
        return (-np.inf, np.inf)
    if near == value:
        return near, near
    if abs(near) < _TINY:
        return -_TINY, _TINY
    return float(np.nextafter(near, -np.inf)), float(np.nextafter(near, np.inf))


def scaled(low: Ints, high: Ints, scale: Fraction) -> tuple[Floats, Floats]:
    """Floats around *scale* > 0 times whole numbers."""
    factor = float(scale) if _TINY < scale < 1 / Fraction(_TINY) else np.nan
    below, above = low * factor, high * factor
    if np.isnan(factor):
        return np.full(low.shape, -np.inf), np.full(high.shape, np.inf)
    return below - np.abs(below) * _SLACK, above + np.abs(above) * _SLACK


def operation(operator: str, operands: Sequence[NumberBounds | TruthBounds]) -> NumberBounds | TruthBounds:
    """What ``operator(*operands)`` may be."""
    if operator == "not":
        (truth,) = truths(operands)
        return TruthBounds(truth.false, truth.true, truth.undefined, truth.fails)
    if operator in ("xor", "iff"):
        return _logical(operator, *truths(operands))
    numbers = _numbers(operands)
    return _compared(operator, *numbers) if operator in COMPARISON_OPERATORS else calculation(operator, numbers)


def calculation(operator: str, operands: Sequence[NumberBounds]) -> NumberBounds:
    """What the number ``operator(*operands)`` may be."""
    defined = np.logical_and.reduce([operand.defined for operand in operands])
    undefined = np.logical_or.reduce([operand.undefined for operand in operands])
    fails = np.logical_or.reduce([operand.fails for operand in operands])
    with np.errstate(all="ignore"):
        low, high, own = _ENDS[operator](*operands)
    vague = defined & (own | ~np.isfinite(low) | ~np.isfinite(high))
    usable = defined & ~vague
    return NumberBounds(np.where(usable, low, 0.0), np.where(usable, high, 0.0), defined, undefined, fails | vague)


def junction(conditions: Sequence[TruthBounds], *, every: bool) -> TruthBounds:
    """What ``and``, if *every*, or ``or`` of *conditions* may be; what stands behind the deciding one does not fail."""
    first = conditions[0]
    fails = first.fails
    agree, decide = (first.true, first.false) if every else (first.false, first.true)
    undecided, undefined, all_agree, one_decides = agree | first.undefined, first.undefined, agree, decide
    for condition in conditions[1:]:
        fails = fails | (undecided & condition.fails)
        agree, decide = (condition.true, condition.false) if every else (condition.false, condition.true)
        one_decides = one_decides | (undecided & decide)
        all_agree = all_agree & agree
        undecided = undecided & (agree | condition.undefined)
        undefined = undefined | condition.undefined
    undefined = undefined & undecided
    return TruthBounds(*((all_agree, one_decides) if every else (one_decides, all_agree)), undefined, fails)


def quota(low: int | None, high: int | None, conditions: Sequence[TruthBounds]) -> TruthBounds:
    """What it may be that between *low* and *high* of *conditions* are true."""
    lowest, highest = low or 0, len(conditions) if high is None else high
    most_true = np.add.reduce([condition.true.astype(np.int64) for condition in conditions])
    least_open = np.add.reduce([(~condition.false).astype(np.int64) for condition in conditions])
    true: Bools = (most_true >= lowest) & (least_open <= highest)
    false: Bools = (least_open < lowest) | (most_true > highest)
    undefined = np.logical_or.reduce([condition.undefined for condition in conditions])
    fails = np.logical_or.reduce([condition.fails for condition in conditions])
    return TruthBounds(true, false, undefined, fails)


def choice(
    condition: TruthBounds, yes: NumberBounds | TruthBounds, no: NumberBounds | TruthBounds
) -> NumberBounds | TruthBounds:
    """What ``if condition then yes else no`` may be."""
    fails = condition.fails | (condition.true & yes.fails) | (condition.false & no.fails)
    undefined = condition.undefined | (condition.true & yes.undefined) | (condition.false & no.undefined)
    if isinstance(yes, TruthBounds) and isinstance(no, TruthBounds):
        true = (condition.true & yes.true) | (condition.false & no.true)
        return TruthBounds(true, (condition.true & yes.false) | (condition.false & no.false), undefined, fails)
    one, other = _numbers([yes, no])
    take, leave = condition.true & one.defined, condition.false & other.defined
    low = np.minimum(np.where(take, one.low, np.inf), np.where(leave, other.low, np.inf))
    high = np.maximum(np.where(take, one.high, -np.inf), np.where(leave, other.high, -np.inf))
    there = take | leave
    return NumberBounds(np.where(there, low, 0.0), np.where(there, high, 0.0), there, undefined, fails)


def truths(operands: Sequence[NumberBounds | TruthBounds]) -> list[TruthBounds]:
    """*operands*, which are conditions."""
    return [operand for operand in operands if isinstance(operand, TruthBounds)]


def _numbers(operands: Sequence[NumberBounds | TruthBounds]) -> list[NumberBounds]:
    return [operand for operand in operands if isinstance(operand, NumberBounds)]


def _logical(operator: str, left: TruthBounds, right: TruthBounds) -> TruthBounds:
    alike = (left.true & right.true) | (left.false & right.false)
    unlike = (left.true & right.false) | (left.false & right.true)
    true, false = (alike, unlike) if operator == "iff" else (unlike, alike)
    return TruthBounds(true, false, left.undefined | right.undefined, left.fails | right.fails)


def _compared(operator: str, left: NumberBounds, right: NumberBounds) -> TruthBounds:
    if operator in (">", ">="):
        left, right, operator = right, left, {">": "<", ">=": "<="}[operator]
    match operator:
        case "<":
            true, false = left.low < right.high, left.high >= right.low
        case "<=":
            true, false = left.low <= right.high, left.high > right.low
        case _:
            true = (left.low <= right.high) & (right.low <= left.high)
            false = ~((left.low == left.high) & (right.low == right.high) & (left.low == right.low))
            true, false = (true, false) if operator == "==" else (false, true)
    defined = left.defined & right.defined
    undefined = left.undefined | right.undefined
    return TruthBounds(true & defined, false & defined, undefined, left.fails | right.fails)


_Ends = tuple[Floats, Floats, Bools]


def _never(operand: NumberBounds) -> Bools:
    return np.zeros(operand.low.shape, bool)


def _add(left: NumberBounds, right: NumberBounds) -> _Ends:
    return _down(left.low + right.low), _up(left.high + right.high), _never(left)


def _subtract(left: NumberBounds, right: NumberBounds) -> _Ends:
    return _down(left.low - right.high), _up(left.high - right.low), _never(left)


def _negative(operand: NumberBounds) -> _Ends:
    return -operand.high, -operand.low, _never(operand)


def _multiply(left: NumberBounds, right: NumberBounds) -> _Ends:
    corners = [_corner(a * b, (a == 0) | (b == 0)) for a in (left.low, left.high) for b in (right.low, right.high)]
    return _outermost(corners)


def _divide(left: NumberBounds, right: NumberBounds) -> _Ends:
    corners = [_corner(a / b, a == 0) for a in (left.low, left.high) for b in (right.low, right.high)]
    low, high, vague = _outermost(corners)
    return low, high, vague | ((right.low <= 0) & (right.high >= 0))


def _power(base: NumberBounds, exponent: NumberBounds) -> _Ends:
    whole = (exponent.low == exponent.high) & (exponent.low == np.floor(exponent.low))
    number = np.where(whole, exponent.low, 0.0)
    # |x|^n grows with |x|; an even n turns what is negative round.
    largest = np.maximum(np.abs(base.low), np.abs(base.high))
    smallest = np.where((base.low <= 0) & (base.high >= 0), 0.0, np.minimum(np.abs(base.low), np.abs(base.high)))
    even = number % 2 == 0
    least, most = np.minimum(smallest**number, largest**number), np.maximum(smallest**number, largest**number)
    odd_low, odd_high = _signed(base.low, number), _signed(base.high, number)
    whole_low = np.where(even, least, np.minimum(odd_low, odd_high))
    whole_high = np.where(even, most, np.maximum(odd_low, odd_high))
    corners = [a**b for a in (base.low, base.high) for b in (exponent.low, exponent.high)]
    low, high = np.minimum.reduce(corners), np.maximum.reduce(corners)
    pole = (number < 0) & (base.low <= 0) & (base.high >= 0)
    fails = np.where(whole, pole | (np.abs(number) > _LARGEST_POWER), base.low <= 0)
    low, high = np.where(whole, whole_low, low), np.where(whole, whole_high, high)
    too_small = ((low != 0) & (np.abs(low) < _TINY)) | ((high != 0) & (np.abs(high) < _TINY))
    return low - np.abs(low) * _SLACK, high + np.abs(high) * _SLACK, fails | too_small


def _signed(base: Floats, number: Floats) -> Floats:
    powered: Floats = np.sign(base) * np.abs(base) ** number
    return powered


def _absolute(operand: NumberBounds) -> _Ends:
    low = np.where(operand.low > 0, operand.low, np.where(operand.high < 0, -operand.high, 0.0))
    return low, np.maximum(np.abs(operand.low), np.abs(operand.high)), _never(operand)


def _square_root(operand: NumberBounds) -> _Ends:
    low = np.sqrt(np.maximum(operand.low, 0.0))
    return _down(low), _up(np.sqrt(np.maximum(operand.high, 0.0))), operand.low < 0


def _floor(operand: NumberBounds) -> _Ends:
    return np.floor(operand.low), np.floor(operand.high), _never(operand)


def _extreme(of: np.ufunc, *operands: NumberBounds) -> _Ends:
    lows, highs = [operand.low for operand in operands], [operand.high for operand in operands]
    return of.reduce(lows), of.reduce(highs), _never(operands[0])


_ENDS: Mapping[str, Callable[..., _Ends]] = {
    "+": _add,
    "-": _subtract,
    "negative": _negative,
    "*": _multiply,
    "/": _divide,
    "^": _power,
    "abs": _absolute,
    "sqrt": _square_root,
    "floor": _floor,
    "min": partial(_extreme, np.minimum),
    "max": partial(_extreme, np.maximum),
}


def _corner(value: Floats, is_zero: Bools) -> Floats:
    """A product or quotient; not a number where it is too small for a float, and so taken for vague."""
    corner: Floats = np.where(is_zero, 0.0, np.where(np.abs(value) < _TINY, np.nan, value))
    return corner


def _outermost(corners: Sequence[Floats]) -> _Ends:
    low, high = np.minimum.reduce(corners), np.maximum.reduce(corners)
    return _down(low), _up(high), np.isnan(low)


def _down(values: Floats) -> Floats:
    # Sums and roots of floats that are 0 are exactly 0.
    low: Floats = np.where(values == 0, 0.0, np.nextafter(values, -np.inf))
    return low


def _up(values: Floats) -> Floats:
    high: Floats = np.where(values == 0, 0.0, np.nextafter(values, np.inf))
    return high
