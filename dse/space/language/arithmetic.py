"""Operators on exact numbers and truth values, either of which may be undefined (None).

A property of an absent part is undefined, and so is what is computed from it. Numbers are Fractions, or floats
behind an inexact function.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction

Real = Fraction | float
ExactValue = Real | bool | str | None

_MOST_BITS = 100_000


class UndefinedError(ArithmeticError):
    """A value that does not exist, as 1/0; the message says which."""


def divide(x: Real, y: Real) -> Real:
    """x/y. Raises UndefinedError for y = 0."""
    if y == 0:
        raise UndefinedError("division by zero")
    return x / y


def raise_to(x: Real, y: Real) -> Real:
    """x^y, exact for a whole exponent. Raises UndefinedError for what is no real number, or has too many digits."""
    if x == 0 and y < 0:
        raise UndefinedError("division by zero")
    if isinstance(x, Fraction) and isinstance(y, Fraction) and y.denominator == 1:
        bits = max(x.numerator.bit_length(), x.denominator.bit_length()) * abs(y.numerator)
        if bits > _MOST_BITS:
            raise UndefinedError("a power of too many digits")
        return Fraction(x**y.numerator)
    if x < 0:
        raise UndefinedError("a fraction as power of a negative number")
    return math.pow(x, y)


def square_root(x: Real) -> Real:
    """√x, exact for squares. Raises UndefinedError for x < 0."""
    if x < 0:
        raise UndefinedError("the square root of a negative number")
    if isinstance(x, Fraction):
        over, under = math.isqrt(x.numerator), math.isqrt(x.denominator)
        if over * over == x.numerator and under * under == x.denominator:
            return Fraction(over, under)
    return math.sqrt(x)


def floor(x: Real) -> Real:
    """The next whole number at or below x."""
    return Fraction(math.floor(x))


def quota(low: int | None, high: int | None, conditions: Sequence[bool | None]) -> bool | None:
    """Whether between *low* and *high* of *conditions* are true; undefined if those that are undefined decide it."""
    least = sum(condition is True for condition in conditions)
    most = len(conditions) - sum(condition is False for condition in conditions)
    lowest, highest = low or 0, len(conditions) if high is None else high
    if most < lowest or least > highest:
        return False
    return True if lowest <= least and most <= highest else None


def roll_up(function: str, values: Sequence[Fraction]) -> Fraction | None:
    """*function*, one of ROLLUPS, of the properties of the parts that are there.

    Of no part at all sum and count are 0 and product is 1; min, max and mean are undefined.
    """
    match function:
        case "sum":
            return sum(values, Fraction(0))
        case "count":
            return Fraction(len(values))
        case "product":
            return math.prod(values, start=Fraction(1))
    if not values:
        return None
    match function:
        case "mean":
            return sum(values, Fraction(0)) / len(values)
        case "min":
            return min(values)
    return max(values)


EXACT_FUNCTIONS: Mapping[str, Callable[..., ExactValue]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": divide,
    "^": raise_to,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "xor": operator.ne,
    "iff": operator.eq,
    "not": operator.not_,
    "negative": operator.neg,
    "abs": abs,
    "sqrt": square_root,
    "floor": floor,
    "min": min,
    "max": max,
}
"""What an operation computes; undefined as soon as one side is."""
