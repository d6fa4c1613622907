"""Traffic: the vehicle ahead is that of straight_road; others drive as their parameters say."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

NewPart = Callable[..., Any]


def test_the_vehicle_ahead_drives_as_that_of_straight_road(new_part: NewPart) -> None:
    @settings(max_examples=15, deadline=None, derandomize=True)
    @given(
        gap=st.floats(1, 300), speed=st.floats(0, 40), time=st.floats(0, 6), rate=st.floats(0, 12),
        final=st.floats(0, 40), start=st.floats(0, 500),
    )  # fmt: skip
    def check(gap: float, speed: float, time: float, rate: float, final: float, start: float) -> None:
        profile = {"lead_speed": speed, "lead_change_time": time, "lead_change_rate": rate, "lead_final_speed": final}
        old = new_part("straight_road", initial_gap=gap, **profile)
        part = new_part("lead_vehicle", initial_gap=gap, **profile)
        part["lane.station"] = start
        old.init()
        part.init()
        travelled = gap
        for _ in range(1000):
            old.step()
            part.step()
            assert part["movers[1].speed"] == old["lead.speed"]
            travelled = old["gap"] + old["position"]
            bumper = part["movers[1].station"] - 2.25 - 2.3 - start
            assert bumper == pytest.approx(travelled, abs=1e-9)

    check()


def test_it_is_one_car_in_its_lane(new_part: NewPart) -> None:
    part = new_part("lead_vehicle", lead_lane=1, lead_offset=-0.3, lead_length=12.0, lead_width=2.5)
    part.init()
    found = {name: part[f"movers[1].{name}"] for name in ("id", "class", "path", "lane", "offset", "length", "width")}
    assert found == {"id": 1, "class": 1, "path": 0, "lane": 1, "offset": -0.3, "length": 12.0, "width": 2.5}
    assert [part[f"movers[{i}].class"] for i in range(2, 9)] == [0] * 7


def test_vehicles_drive_the_way_they_are_turned(new_part: NewPart) -> None:
    part = new_part("vehicles")
    for name, value in {
        "class[2]": 2, "path[2]": 1, "lane_number[2]": -1, "station[2]": 80.0, "speed[2]": 10.0, "turn[2]": math.pi,
        "class[8]": 5, "station[8]": 40.0, "speed[8]": 2.0, "turn[8]": math.pi / 2, "offset[8]": -3.0,
        "change_time[8]": 1.0, "change_rate[8]": 1.0, "final_speed[8]": 0.0, "clearance[2]": 4.5,
    }.items():  # fmt: skip
        part[name] = value
    part.init()
    for _ in range(500):
        part.step()
    assert [part[f"movers[{i}].class"] for i in range(1, 9)] == [0, 2, 0, 0, 0, 0, 0, 5]
    assert (part["movers[2].path"], part["movers[2].lane"], part["movers[2].id"]) == (1, -1, 2)
    assert (part["movers[2].clearance"], part["movers[8].clearance"]) == (4.5, 0)
    assert part["movers[2].station"] == pytest.approx(80 - 50, abs=1e-9)
    assert part["movers[2].offset"] == pytest.approx(0, abs=1e-9)
    # A pedestrian who crosses stops after 2 m at 2 m/s and 2 m of braking.
    assert part["movers[8].offset"] == pytest.approx(-3 + 2 + 2, abs=1e-9)
    assert part["movers[8].station"] == pytest.approx(40, abs=1e-9)
    assert part["movers[8].speed"] == 0
