"""A vehicle that changes lanes before the host does so at the gap, the time and the lateral speed set."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

NewPart = Callable[..., Any]
H, FRONT = 0.01, 2.3
NAMES = ("station", "offset", "turn", "speed", "acceleration")


def drive(part: Any, host: float, steps: int, start: float = 100.0) -> Any:
    """Station, offset, turn, speed, acceleration and the host's gap by row; the host keeps its speed."""
    rows = []
    for k in range(steps):
        part["lane.station"], part["motion.speed"] = start + host * H * k, host
        (part.step if k else part.init)()
        place = [part[f"movers[1].{name}"] for name in NAMES]
        rows.append((*place, place[0] - 2.25 - FRONT - (start + host * H * k)))
    return np.array(rows)


def quintic(time: Any, duration: float) -> Any:
    """By its boundary conditions: from 0 to 1 with neither speed nor acceleration at both ends."""
    ends = np.array([[1, 1, 1], [3, 4, 5], [6, 12, 20]])
    a, b, c = np.linalg.solve(ends, [1, 0, 0])
    u = np.clip(time / duration, 0, 1)
    return a * u**3 + b * u**4 + c * u**5


def test_it_changes_lanes_at_the_gap_by_a_quintic_of_that_lateral_speed(new_part: NewPart) -> None:
    @settings(max_examples=25, deadline=None, derandomize=True)
    @given(
        host=st.floats(15, 35), slower=st.floats(2, 8), gap=st.floats(5, 40), sideways=st.floats(0.5, 2.2),
        width=st.floats(3, 4), side=st.sampled_from([-1, 1]), overtakes=st.booleans(),
    )  # fmt: skip
    def check(
        host: float, slower: float, gap: float, sideways: float, width: float, side: int, overtakes: bool
    ) -> None:
        relative, first = (slower, gap - 15) if overtakes else (-slower, gap + 15)
        rows = drive(
            new_part("cut_in", speed=relative, speed_over="host", initial_gap=first, begin_gap=gap,
                     lateral_speed=sideways, lane_width=width, from_lane=side), host, 3000,
        )  # fmt: skip
        gaps, offsets = rows[:, 5], rows[:, 1]
        assert np.allclose(gaps, first + relative * H * np.arange(3000), atol=1e-9)
        begin = int(np.argmax((gaps - gap) * (first - gap) <= 1e-9))
        assert abs(H * begin - 15 / slower) <= H * (1 + 1e-9)
        duration = 1.875 * width / sideways
        late = [
            side * width * (1 - quintic(H * (np.arange(3000) - begin - shift), duration)) - offsets
            for shift in (0, 1)  # rounding may put the gap's tick on either side
        ]
        assert min(np.abs(each).max() for each in late) < 1e-9
        assert np.abs(np.diff(offsets)).max() / H == pytest.approx(sideways, rel=1e-3)
        assert offsets[-1] == 0
        # It heads where it goes.
        along, aside = rows[:, 3] * np.cos(rows[:, 2]), rows[:, 3] * np.sin(rows[:, 2])
        assert np.allclose(along, host + relative, atol=1e-12)
        assert np.allclose((aside[1:] + aside[:-1]) / 2, np.diff(offsets) / H, atol=1e-3)

    check()


def test_it_begins_between_two_ticks_where_the_time_says_so_and_brakes_after_the_delay(new_part: NewPart) -> None:
    rows = drive(
        new_part("cut_in", begin="time", begin_time=1.234, lateral_speed=1.75, speed=20.0, change_delay=0.5,
                 change_rate=4.0, final_speed=12.0), 20.0, 1000,
    )  # fmt: skip
    time = H * np.arange(1000)
    assert np.allclose(rows[:, 1], 3.5 * (1 - quintic(time - 1.234, 3.75)), atol=1e-12)
    speeds = np.clip(20 - 4 * (time - 1.734), 12, 20)
    assert np.allclose(rows[:, 3] * np.cos(rows[:, 2]), speeds, atol=1e-12)
    braked = np.clip(time - 1.734, 0, 2)
    expected = 20 * time - 2 * braked**2 - 8 * np.clip(time - 3.734, 0, None)
    assert np.allclose(rows[:, 0] - rows[0, 0], expected, atol=1e-9)


def test_who_stops_while_it_changes_lanes_stands_as_it_drove(new_part: NewPart) -> None:
    rows = drive(
        new_part("cut_in", begin="time", begin_time=0.5, speed=8.0, change_rate=2.5, lateral_speed=1.0), 8.0, 800
    )
    assert rows[-1, 3] == 0
    assert 0.5 < rows[-1, 1] < 3
    moving = np.abs(np.diff(rows[:, 1])) > 0
    assert np.all(np.abs(np.diff(rows[:, 1])) <= 0.3 * np.diff(rows[:, 0]) * (1 + 1e-6) + 1e-15)
    assert not moving[400:].any()
    assert rows[-1, 2] < -0.05  # its heading stays
    assert np.abs(np.diff(rows[:, 2])).max() < 0.02


def test_a_cut_out_reveals_who_stands(new_part: NewPart) -> None:
    part = new_part("cut_out", begin_gap=55.0, standing_gap=180.0, initial_gap=30.0)
    rows = drive(part, 20.0, 1200)
    assert (part["movers[2].class"], part["movers[2].id"], part["movers[2].speed"]) == (1, 2, 0)
    assert part["movers[2].station"] == pytest.approx(100 + FRONT + 180 + 2.25, abs=1e-12)
    assert (part["movers[2].offset"], part["movers[2].lane"]) == (0, 0)
    ahead = part["movers[2].station"] - 2.25 - (rows[:, 0] + 2.25)
    begin = int(np.argmax(ahead <= 55 + 1e-9))
    assert np.allclose(rows[:, 1], 3.5 * quintic(H * (np.arange(1200) - begin), 1.875 * 3.5 / 1.5), atol=0.02)
    assert rows[-1, 1] == 3.5
    assert math.isclose(H * begin, (180 - 30 - 4.5 - 55) / 20, abs_tol=H * 1.001)
    # It is past the one that stands before their bodies could touch.
    touching = (ahead < 0) & (ahead > -9) & (rows[:, 1] < 1.8)
    assert not touching.any()


def test_without_a_begin_it_keeps_its_lane_and_nobody_stands(new_part: NewPart) -> None:
    part = new_part("cut_in", speed=2.0, speed_over="host", initial_gap=60.0, begin_gap=20.0, from_lane=-1, host_lane=1)
    rows = drive(part, 20.0, 500)
    assert set(rows[:, 1]) == {-7.0}
    assert part["movers[1].lane"] == 1
    assert [part[f"movers[{i}].class"] for i in range(1, 9)] == [1, 0, 0, 0, 0, 0, 0, 0]
