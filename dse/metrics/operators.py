"""Operators on numbers and waveforms alike, after IEEE 754; comparisons with NaN are false."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np


def is_true(x: Any) -> Any:
    """Whether a recorded 0 or 1 stands for true."""
    return np.not_equal(x, 0.0)


def differs(x: Any, y: Any) -> Any:
    """x != y; false where one is NaN."""
    return np.logical_or(np.less(x, y), np.greater(x, y))


def implies(x: Any, y: Any) -> Any:
    """not x or y."""
    return np.logical_or(np.logical_not(x), y)


def select(condition: Any, yes: Any, no: Any) -> Any:
    """*yes* where the condition holds, else *no*."""
    if np.ndim(condition) == 0:
        return yes if condition else no
    return np.where(condition, yes, no)


OPERATORS: Mapping[str, Callable[..., Any]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "^": np.power,
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": differs,
    "and": np.logical_and,
    "or": np.logical_or,
    "xor": np.logical_xor,
    "implies": implies,
    "iff": np.equal,
}
"""The operators of the expression language."""
