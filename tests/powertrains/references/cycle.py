"""A speed cycle like the WLTC: four phases of rising speed, 1800 s, one continuous acceleration."""

from __future__ import annotations

import math

DURATION = 1800.0
"""Of the cycle in s."""

# (duration in s, speed in km/h at its end). Phases end at standstill, at 589, 1022, 1477 and 1800 s, as in class 3 of
# UN Regulation 154; peaks are those of its phases (56.5, 76.6, 97.4, 131.3 km/h), the rest is made up.
# fmt: off
_SECTIONS = (
    # low
    (11, 0), (14, 46), (10, 40), (20, 18), (12, 30), (14, 0), (25, 0), (16, 42), (22, 47), (14, 25), (20, 56.5),
    (40, 50), (18, 12), (14, 35), (25, 33), (16, 0), (60, 0), (14, 25), (12, 14), (16, 44), (50, 41), (16, 0),
    (30, 0), (12, 28), (30, 22), (14, 0), (44, 0),
    # medium
    (14, 48), (30, 52), (16, 20), (20, 66), (60, 62), (20, 35), (18, 76.6), (80, 70), (25, 38), (16, 60), (40, 56),
    (24, 0), (70, 0),
    # high
    (22, 72), (60, 68), (20, 40), (24, 92), (80, 85), (30, 97.4), (70, 78), (20, 50), (20, 82), (50, 74), (27, 0),
    (32, 0),
    # extra high
    (28, 88), (20, 74), (30, 112), (40, 124), (30, 118), (25, 131.3), (60, 126), (40, 104), (37, 0), (13, 0),
)
# fmt: on


def speed(time: float) -> float:
    """Target speed in m/s at *time* in s; 0 outside the cycle."""
    before, since = 0.0, time
    for duration, kmh in _SECTIONS:
        after = kmh / 3.6
        if 0 <= since < duration:
            part = since / duration
            return before + (after - before) * part**3 * (10 - 15 * part + 6 * part * part)
        before, since = after, since - duration
    return 0.0


def acceleration(time: float) -> float:
    """Time derivative of `speed` in m/s2."""
    before, since = 0.0, time
    for duration, kmh in _SECTIONS:
        after = kmh / 3.6
        if 0 <= since < duration:
            part = since / duration
            return (after - before) / duration * 30 * (part * (1 - part)) ** 2
        before, since = after, since - duration
    return 0.0


def distance() -> float:
    """Length of the cycle in m: half the sum of both ends' speeds, by the symmetry of the sections."""
    ends = [0.0, *(kmh / 3.6 for _, kmh in _SECTIONS)]
    return math.fsum(
        duration * 0.5 * (before + after)
        for (duration, _), before, after in zip(_SECTIONS, ends[:-1], ends[1:], strict=True)
    )
