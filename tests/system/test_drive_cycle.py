"""The WLTC-like cycle: its figures are those of class 3b of UN GTR 15."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

PHASES = {  # s, s at standstill, m, km/h
    "low": (0, 589, 156, 3095, 56.5),
    "medium": (589, 1022, 48, 4756, 76.6),
    "high": (1022, 1477, 31, 7162, 97.4),
    "extra_high": (1477, 1800, 7, 8254, 131.3),
}
"""Begin and end, standstill, distance and highest speed of each phase (UN GTR 15, annex 1)."""

TEXT = (Path(__file__).parents[2] / "testbenches" / "wltc_like.csv").read_text(encoding="utf-8")
TIME, SPEED = np.loadtxt([line for line in TEXT.splitlines() if line[0].isdigit()], delimiter=",", unpack=True)


@pytest.mark.parametrize(("start", "end", "standstill", "metres", "fastest"), PHASES.values(), ids=PHASES)
def test_a_phase_has_the_duration_stops_distance_and_highest_speed_of_the_regulation(
    start, end, standstill, metres, fastest
):
    time, speed = (column[np.searchsorted(TIME, start) : np.searchsorted(TIME, end) + 1] for column in (TIME, SPEED))
    assert (time[0], time[-1], speed[0], speed[-1]) == (start, end, 0, 0)
    assert np.diff(time)[(speed[1:] == 0) & (speed[:-1] == 0)].sum() == standstill
    assert speed.max() == fastest
    assert np.trapezoid(speed / 3.6, time) == pytest.approx(metres, abs=1)  # speeds have steps of 0.1 km/h


def test_a_car_can_follow_the_cycle():
    """1.2 m/s² is what the file claims; the regulation's own cycle has up to 1.67 m/s²."""
    assert (np.diff(TIME) > 0).all()
    assert np.abs(np.diff(SPEED) / 3.6 / np.diff(TIME)).max() <= 1.2
