"""Operators on exact numbers and truth values, either of which may be undefined (None).

A property of an absent part is undefined, and so is what is computed from it; `and`, `or` and `implies` are
Kleene's: ``false and undefined`` is false. Numbers are Fractions, or floats behind an inexact function.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from fractions import Fraction

Real = Fraction | float
Value = Real | bool | str | None

_MOST_BITS = 100_000


class UndefinedError(ArithmeticError):
    """A value that does not exist, as 1/0; the message says which."""


def negate(x: Real) -> Real:
    """-x."""
    return -x


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


def conjunction(left: bool | None, right: Callable[[], bool | None]) -> bool | None:
    """left and right."""
    if left is False:
        return False
    other = right()
    if other is False:
        return False
    return None if left is None or other is None else True


def disjunction(left: bool | None, right: Callable[[], bool | None]) -> bool | None:
    """left or right."""
    if left is True:
        return True
    other = right()
    if other is True:
        return True
    return None if left is None or other is None else False


def opposite(x: bool | None) -> bool | None:
    """not x."""
    return None if x is None else not x


PLAIN_OPERATORS: Mapping[str, Callable[..., Value]] = {
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
}
"""Operators that are undefined as soon as one side is."""
