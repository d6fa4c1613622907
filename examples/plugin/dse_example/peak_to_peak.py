"""A metric function: ``peak_to_peak(spring.y)``."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.plugins import Argument, Wants, metric_function, same


def peak_to_peak(x: NDArray[Any]) -> float:
    """Largest less smallest value, in x's unit; NaN if x has one."""
    return float(np.max(x) - np.min(x))


PEAK_TO_PEAK = metric_function(peak_to_peak, [Argument("x", Wants.WAVEFORM, any_unit=True)], same)
