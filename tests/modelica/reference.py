"""Trajectories computed by scipy at 1e-12, piece by piece between events."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Floats = NDArray[np.float64]
Right = Callable[[float, Floats], Sequence[float]]


def trajectory(right: Right, start: Sequence[float], stop: float, method: str = "DOP853") -> Callable[[float], Floats]:
    """The solution of ``x' = right(t, x)`` from *start* at 0 as a function of time, at 1e-12."""
    found = solve_ivp(right, (0, stop), start, method=method, rtol=1e-12, atol=1e-13, dense_output=True)
    assert found.success, found.message
    dense = found.sol
    return lambda time: np.asarray(dense(min(time, stop)))


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """Where *function* vanishes between *low* and *high*, to the last bits."""
    from scipy.optimize import brentq

    return float(brentq(function, low, high, xtol=1e-15, rtol=1e-15))


remembered = cache
