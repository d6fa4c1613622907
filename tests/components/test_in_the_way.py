"""Collisions and sensors ask for the level of a road user; traffic keeps to the lanes of its class."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from components.test_stream_traffic import MOVER

NewPart = Callable[..., Any]
ALONE = {"minds_host": False}
CARS, BICYCLES = 0b1110, 0b10000


def place(part: Any, **values: Any) -> None:
    car = {"id": 1, "class": "car", "length": 4.5, "width": 1.8, "height": 1.5, "x": 3.0, "ahead": 3.0}
    for name, value in {**car, **values}.items():
        part[f"actors[1].{name}"] = value


@pytest.mark.parametrize(
    ("above", "height", "hit"),
    [(0.0, 1.5, True), (8.0, 1.5, False), (1.55, 1.5, True), (1.65, 1.5, False), (-1.3, 1.5, True), (-1.45, 1.5, False),
     (-3.0, 3.5, True), (-6.0, 1.5, False)],
)  # fmt: skip
def test_a_car_collides_with_what_reaches_into_its_height(
    new_part: NewPart, above: float, height: float, hit: bool
) -> None:
    part = new_part("ray_scanner")
    part["lane.width"] = 3.5
    place(part, above=above, height=height)
    part.init()
    assert (part["collision"], part["scene.hit"], part["lead.id"]) == (hit, hit, int(hit))


@pytest.mark.parametrize("sensor", ["object_radar_long", "object_lidar", "object_camera", "object_perfect"])
def test_no_sensor_sees_who_is_on_another_level_or_is_hidden_by_it(new_part: NewPart, sensor: str) -> None:
    for above in (0.0, 8.0, -8.0):
        part = new_part(sensor)
        place(part, x=40.0, above=above)
        place_behind(part)
        part.init()
        for _ in range(40):
            part.step()
        ranges = [part[f"scan.returns[{k}].range"] for k in (1, 2) if part[f"scan.returns[{k}].valid"]]
        assert (min(ranges, default=0.0) < 40) == (above == 0)
        assert (max(ranges, default=0.0) > 50) == (above != 0 or sensor == "object_perfect")


def place_behind(part: Any) -> None:
    for name, value in {"id": 2, "class": "car", "length": 4.5, "width": 1.7, "height": 1.5, "x": 60.0}.items():
        part[f"actors[2].{name}"] = value


def crowd(part: Any, count: int) -> Any:
    at = ctypes.addressof(part.slots["everyone[1].id"][1]) - ctypes.addressof(part.memory)
    return np.frombuffer(bytes(part.memory), MOVER, count, at)


def road(part: Any, *lanes: tuple[float, float, int], leftmost: int = 0) -> None:
    """One path of 3 km with lanes (middle, width, users) from the rightmost on."""
    part["paths[1].length"], part["paths[1].lane_width"] = 3000.0, 3.5
    part["paths[1].leftmost"], part["paths[1].rightmost"] = leftmost, leftmost - len(lanes) + 1
    for k, (middle, width, users) in enumerate(lanes, 1):
        part[f"paths[1].lanes[{k}].middle"], part[f"paths[1].lanes[{k}].width"] = middle, width
        part[f"paths[1].lanes[{k}].users"] = users


def lanes(part: Any, count: int, steps: int = 400) -> dict[int, set[float]]:
    """In which lanes the users of each class are, while none changes lanes."""
    part.init()
    found: dict[int, set[float]] = {}
    for _ in range(steps):
        part.step(0.1)
        for user in crowd(part, count):
            if user["class"] and user["turn"] == 0:
                found.setdefault(int(user["class"]), set()).add(float(user["lane"]))
                assert user["offset"] == 0
    return found


def test_vehicles_keep_to_the_middles_of_the_lanes_of_their_class(new_part: NewPart) -> None:
    part = new_part(
        "stream_traffic", **ALONE, count=60, truck_share=0.3, motorcycle_share=0.1, cyclists=3, politeness=0.0
    )
    road(part, (-5.5, 1.5, BICYCLES), (-3.25, 3.0, 0), (0.0, 3.5, CARS), (3.375, 3.25, CARS), leftmost=1)
    found = lanes(part, 63)
    assert found[1] == found[2] == {0, 1}
    assert found[3] <= {0, 1}
    assert found[4] == {-2}


def test_no_truck_changes_to_a_lane_that_is_not_for_trucks(new_part: NewPart) -> None:
    part = new_part("stream_traffic", **ALONE, count=80, truck_share=0.5, politeness=0.0, truck_speed=28.0)
    road(part, (0.0, 3.5, CARS), (3.5, 3.5, CARS & ~0b100), leftmost=1)
    found = lanes(part, 80)
    assert found[2] == {0}
    assert found[1] == {0, 1}


def test_a_path_without_a_lane_for_vehicles_has_no_room_for_them(new_part: NewPart) -> None:
    part = new_part("stream_traffic", **ALONE, count=1)
    road(part, (0.0, 3.0, 0))
    part.init()
    assert np.isnan(part["movers[1].station"])


def test_a_driver_overtakes_on_a_lane_but_not_on_a_hard_shoulder(new_part: NewPart) -> None:
    farthest = []
    for users in (CARS, 0):
        part = new_part("idm_traffic", **ALONE, lap_length=3000.0, right_lane=-1, left_lane=0, politeness=0.0)
        road(part, (-3.5, 3.5, users), (0.0, 3.5, CARS))
        for number, (station, speed) in enumerate([(300.0, 10.0), (150.0, 20.0)], 1):
            for name, value in {"class": 1, "station": station, "speed": speed, "desired_speed": speed}.items():
                part[f"{name}[{number}]"] = value
        part.init()
        lanes = []
        for _ in range(300):
            part.step(0.1)
            lanes.append(part["movers[2].lane"])
        farthest.append(min(lanes))
    assert farthest == [-1, 0]
