"""The communication points of a run: time is always ``k * step``, never a sum."""

from __future__ import annotations

import math

from dse.errors import fail

_TOLERANCE = 1e-9  # of stop/step from a whole number: far above rounding, far below a step


def steps_in(stop: float, step: float) -> int:
    """Number of communication steps to *stop* (seconds); DseError unless it is a whole number, at least one."""
    if not (math.isfinite(stop) and math.isfinite(step) and step > 0 and stop > 0):
        raise fail(f"cannot simulate {stop:g} s in steps of {step:g} s", hint="both must be positive and finite")
    count = round(stop / step)
    if count < 1 or abs(stop / step - count) > _TOLERANCE * max(1, count):
        raise fail(
            f"the stop time of {stop:.10g} s is not a whole number of steps of {step:.10g} s",
            hint=f"stop at {max(1, count) * step:.10g} s",
        )
    return count


def end_of(stop: float, step: float, steps: int) -> float:
    """The stop time to announce to FMUs: *stop*, or where the last step ends if rounding puts that a bit later.

    FMUs may refuse a step that ends past the announced stop time, if only by the last bit.
    """
    return max(stop, (steps - 1) * step + step, steps * step)
