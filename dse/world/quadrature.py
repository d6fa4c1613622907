"""Integrals by sixteen points (Gauss and Legendre), with the same bits on every processor: BLAS and LAPACK add in an
order of the processor's own, in threads in one that chance decides."""

from __future__ import annotations

import math
from functools import cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

_POINTS = 16

T = TypeVar("T", np.float64, np.complex128)


@cache
def gauss() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points in 0 ... 1 and their weights, which add up to 1 (Newton's method on Legendre's recurrence)."""
    x = np.array([-math.cos(math.pi * (i + 0.75) / (_POINTS + 0.5)) for i in range(_POINTS)])
    for _ in range(8):
        before, value = np.ones(_POINTS), x
        for n in range(2, _POINTS + 1):
            before, value = value, ((2 * n - 1) * x * value - (n - 1) * before) / n
        slope = _POINTS * (x * value - before) / (x * x - 1)
        x = x - value / slope
    return (x + 1) / 2, 1 / ((1 - x * x) * slope**2)


def weighed(values: NDArray[T]) -> NDArray[T]:
    """The mean of *values* (…, 16) at the points, by their weights."""
    weights = gauss()[1]
    found = values[..., 0] * weights[0]
    for n in range(1, _POINTS):
        found = found + values[..., n] * weights[n]
    return np.asarray(found)
