"""Someone who crosses the host's path is at the conflict point when the host would be there."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

NewPart = Callable[..., Any]
H, FRONT = 0.01, 2.3

WAYS = {
    "speed": st.floats(0.5, 8), "acceleration": st.floats(0.3, 5), "start_offset": st.floats(-9, -4),
    "end_offset": st.floats(3, 9), "conflict_offset": st.floats(-3, 2.5), "mirrored": st.booleans(),
}  # fmt: skip


def crosser(new_part: NewPart, mirrored: bool = False, **parameters: Any) -> Any:
    if mirrored:
        parameters |= {name: -value for name, value in parameters.items() if name.endswith("_offset")}
    part = new_part("crossing", **parameters)
    part.init()
    return part


def arrival(offsets: list[float], conflict: float) -> float:
    """When the conflict point is passed, straight between two ticks."""
    for k, (before, after) in enumerate(itertools.pairwise(offsets)):
        if (before - conflict) * (after - conflict) <= 0 and before != after:
            return H * (k + (conflict - before) / (after - before))
    return math.nan


def test_it_reaches_the_conflict_point_when_the_host_does(new_part: NewPart) -> None:
    @settings(max_examples=15, deadline=None, derandomize=True)
    @given(host=st.floats(5, 30), seconds=st.floats(20, 24), **WAYS)
    def check(host: float, seconds: float, **ways: Any) -> None:
        part = crosser(new_part, station=1000.0, **ways)
        offsets = []
        for k in range(2600):
            part["lane.station"] = 1000 - FRONT - host * (seconds - H * k)
            part["motion.speed"] = host
            (part.step if k else part.init)()
            offsets.append(part["movers[1].offset"])
        conflict = -ways["conflict_offset"] if ways["mirrored"] else ways["conflict_offset"]
        assert arrival(offsets, conflict) == pytest.approx(seconds, abs=H)

    check()


def test_it_reaches_the_conflict_point_at_the_time_set_and_moves_as_a_body_does(new_part: NewPart) -> None:
    @settings(max_examples=15, deadline=None, derandomize=True)
    @given(at=st.floats(1, 24), **WAYS)
    def check(at: float, **ways: Any) -> None:
        part = crosser(new_part, timing="time", conflict_time=at, **ways)
        states = []
        for _ in range(5000):
            states.append(tuple(part[f"movers[1].{name}"] for name in ("offset", "speed", "acceleration", "turn")))
            part.step()
        sense = -1 if ways["mirrored"] else 1
        offsets = [state[0] for state in states]
        assert arrival(offsets, sense * ways["conflict_offset"]) == pytest.approx(at, abs=H)
        assert states[-1][:3] == (pytest.approx(sense * ways["end_offset"], abs=1e-12), 0, 0)
        assert {state[3] for state in states} == {sense * math.pi / 2}
        for (place, speed, _, _), (next_place, next_speed, _, _) in itertools.pairwise(states):
            # The way of a tick lies between those of both speeds; speed changes by no more than the acceleration.
            assert abs(sense * (next_place - place) - H * (speed + next_speed) / 2) <= ways["acceleration"] * H * H
            assert abs(next_speed - speed) <= ways["acceleration"] * H * (1 + 1e-9)
            assert 0 <= next_speed <= ways["speed"]

    check()


def test_a_short_way_is_crossed_without_reaching_the_speed(new_part: NewPart) -> None:
    part = crosser(new_part, timing="time", conflict_time=2.0, speed=5.0, acceleration=1.0, start_offset=-2.0,
                   end_offset=2.0)  # fmt: skip
    speeds = []
    for _ in range(500):
        part.step()
        speeds.append(part["movers[1].speed"])
    assert max(speeds) == pytest.approx(2.0, abs=1e-9)  # half of 4 m at 1 m/s2
    assert speeds.index(max(speeds)) == 199


def test_a_host_that_stands_or_is_past_lets_it_stand_and_one_that_jumps_moves_it_no_faster(new_part: NewPart) -> None:
    part = crosser(new_part, station=100.0)
    for station, speed in ((0.0, 0.0), (100.0, 20.0), (200.0, 20.0)):
        part["lane.station"], part["motion.speed"] = station, speed
        for _ in range(100):
            part.step()
        assert part["movers[1].offset"] == -6.0
    part["lane.station"], part["motion.speed"] = 95.0, 30.0
    before = part["movers[1].offset"]
    for _ in range(600):
        part.step()
        assert 0 <= part["movers[1].offset"] - before <= 5 / 3.6 * H * (1 + 1e-9)
        before = part["movers[1].offset"]
    assert before > 0


def test_on_a_closed_path_the_host_comes_round(new_part: NewPart) -> None:
    part = crosser(new_part, station=10.0, lap_length=400.0)
    passed = None
    for k in range(1500):
        part["lane.station"] = (300 + 12 * H * k) % 400
        part["motion.speed"] = 12.0
        (part.step if k else part.init)()
        if passed is None and part["movers[1].offset"] >= 0:
            passed = k * H
    assert passed == pytest.approx((110 - FRONT) / 12, abs=1.01 * H)


def test_a_conflict_point_beside_its_way_has_no_answer(new_part: NewPart) -> None:
    for ways in ({"conflict_offset": 7.0}, {"conflict_offset": -6.1}, {"end_offset": -6.0}):
        assert math.isnan(crosser(new_part, **ways)["movers[1].offset"])
