"""What each scalar operator computes: IEEE doubles as the C code has them, never an exception."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping


def _guarded(function: Callable[..., float]) -> Callable[..., float]:
    def computed(*values: float) -> float:
        try:
            return float(function(*values))
        except OverflowError:
            return math.inf
        except ValueError:
            return math.nan

    return computed


def _divide(left: float, right: float) -> float:
    if right:
        return left / right
    if left == 0 or math.isnan(left):
        return math.nan
    return math.copysign(math.inf, left) * math.copysign(1.0, right)


def _power(base: float, exponent: float) -> float:
    if exponent.is_integer() and abs(exponent) <= 16:
        # As the C code: binary powers, rounded in the same order.
        product, square, rest = 1.0, base, int(abs(exponent))
        while rest:
            if rest & 1:
                product *= square
            rest >>= 1
            if rest:
                square *= square
        return product if exponent >= 0 else _divide(1.0, product)
    if base == 0 and exponent < 0:
        is_odd = exponent.is_integer() and exponent % 2 == 1
        return math.copysign(math.inf, base) if is_odd else math.inf
    try:
        return math.pow(base, exponent)
    except OverflowError:
        is_odd = exponent.is_integer() and exponent % 2 == 1
        return -math.inf if base < 0 and is_odd else math.inf
    except ValueError:
        return math.nan


def _logarithm(function: Callable[[float], float]) -> Callable[[float], float]:
    def computed(value: float) -> float:
        if value == 0:
            return -math.inf
        return function(value) if value > 0 else math.nan

    return computed


def _rounded(function: Callable[[float], int]) -> Callable[[float], float]:
    return lambda value: float(function(value)) if math.isfinite(value) else value


def _sinh(value: float) -> float:
    try:
        return math.sinh(value)
    except OverflowError:
        return math.copysign(math.inf, value)


# fmt: off
FUNCTIONS: Mapping[str, Callable[..., float]] = {
    "add": lambda a, b: a + b, "subtract": lambda a, b: a - b, "multiply": lambda a, b: a * b, "divide": _divide,
    "negate": lambda a: -a, "power": _power,
    "minimum": lambda a, b: a if a < b or a != a else b,  # noqa: PLR0124 (only NaN differs from itself, as in C)
    "maximum": lambda a, b: a if a > b or a != a else b,  # noqa: PLR0124 (only NaN differs from itself, as in C)
    "less": lambda a, b: float(a < b), "less_equal": lambda a, b: float(a <= b), "greater": lambda a, b: float(a > b),
    "greater_equal": lambda a, b: float(a >= b), "equal": lambda a, b: float(a == b),
    "not_equal": lambda a, b: float(a != b), "and": lambda a, b: float(a != 0 and b != 0),
    "or": lambda a, b: float(a != 0 or b != 0), "not": lambda a: float(a == 0),
    "if": lambda condition, a, b: a if condition != 0 else b, "prescribed": lambda value, _: value, "abs": abs,
    "sign": lambda value: 1.0 if value > 0 else -1.0 if value < 0 else value, "sqrt": _guarded(math.sqrt),
    "sin": _guarded(math.sin), "cos": _guarded(math.cos), "tan": _guarded(math.tan), "asin": _guarded(math.asin),
    "acos": _guarded(math.acos), "atan": math.atan, "atan2": math.atan2, "sinh": _sinh, "cosh": _guarded(math.cosh),
    "tanh": math.tanh, "exp": _guarded(math.exp),
    "log": _logarithm(math.log), "log10": _logarithm(math.log10), "floor": _rounded(math.floor),
    "ceil": _rounded(math.ceil),
}
# fmt: on
"""Every operator over scalars. Out of its domain an operator gives NaN, at a pole or on overflow an infinity."""
