"""The yield assistant against closed forms of stopping and of times at a crossing."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

NewPart = Callable[..., Any]
FRONT, REAR, GAP, BEGINS, MOST = 2.3, 2.3, 1.0, 2.5, 6.0  # start values
NONE, LIGHT, YIELD = range(3)
ENTRY, EXIT = 100.0, 102.0


def new(new_part: NewPart, speed: float, station: float = 0.0, **parameters: Any) -> Any:
    part = new_part("yield_assistant", jerk=100.0, **parameters)
    part["motion.speed"], part["lane.station"] = speed, station
    part["conflicts[1].entry"], part["conflicts[1].exit"], part["conflicts[1].other_path"] = ENTRY, EXIT, 1
    part["conflicts[1].other_entry"], part["conflicts[1].other_exit"] = 50.0, 52.0
    part["conflicts[1].gives_way"] = True
    part.init()
    return part


def comes(part: Any, time: float, speed: float = 10.0, side: float = -1.0) -> None:
    """An object from the right (side -1) whose nearest point is so many s before the middle of the conflict."""
    part["tracks[1].id"] = 1
    part["tracks[1].x"] = (ENTRY + EXIT) / 2 - part["lane.station"]
    part["tracks[1].y"] = side * time * speed
    part["tracks[1].vx"], part["tracks[1].vy"] = 0.0, -side * speed


def brakes(part: Any, steps: int = 50) -> tuple[float, int]:
    for _ in range(steps):
        part.step()
    return part["deceleration"], int(part["reason"])


def in_the_way_at(speed: float, station: float) -> tuple[float, float]:
    """When the car's front enters and its rear leaves."""
    way = ENTRY - station - FRONT
    return way / speed, (way + EXIT - ENTRY + FRONT + REAR) / speed


@pytest.mark.parametrize("beyond", [-0.02, 0.02])
def test_it_waits_for_those_whose_time_in_the_conflict_comes_within_the_margin(
    new_part: NewPart, beyond: float
) -> None:
    speed, station, other = 10.0, 78.0, 10.0  # near enough for braking to begin
    enters, leaves = in_the_way_at(speed, station)
    length = (52.0 - 50.0) / 2 / other
    later = new(new_part, speed, station)
    comes(later, leaves + 1.5 + length + beyond, other)
    assert (brakes(later)[0] == 0) == (beyond > 0)
    earlier = new(new_part, speed, station)
    comes(earlier, enters - 1.5 - length - 5.0 / other - beyond, other)
    assert (brakes(earlier)[0] == 0) == (beyond > 0)


def test_braking_begins_at_its_deceleration_and_is_what_an_even_stop_takes(new_part: NewPart) -> None:
    speed = 12.0
    begins = ENTRY - GAP - FRONT - speed**2 / (2 * BEGINS)
    part = new(new_part, speed, begins - 0.1)
    comes(part, in_the_way_at(speed, begins)[0])
    assert brakes(part) == (0.0, NONE)
    part["lane.station"] = begins + 0.1
    comes(part, in_the_way_at(speed, begins)[0])
    told, reason = brakes(part)
    assert told == pytest.approx(speed**2 / (2 * (ENTRY - GAP - FRONT - begins - 0.1)))
    assert reason == YIELD
    assert part["brake_torque"] == pytest.approx(1600 * told * 0.31)


def test_a_car_that_stops_so_stands_before_the_conflict_and_goes_on_when_it_is_free(new_part: NewPart) -> None:
    part = new(new_part, 13.0)
    speed, station = 13.0, 0.0
    for _ in range(3000):
        comes(part, 2.0)  # somebody always comes
        part["motion.speed"], part["lane.station"] = speed, station
        part.step()
        station += max(speed * 0.01 - part["deceleration"] * 5e-5, 0.0)
        speed = max(speed - part["deceleration"] * 0.01, 0.0)
        assert part["deceleration"] <= 1.2 * BEGINS
    assert speed == 0
    assert station + FRONT == pytest.approx(ENTRY - GAP, abs=0.1)
    assert part["deceleration"] > 0
    part["tracks[1].id"] = 0
    assert brakes(part) == (0.0, NONE)


@pytest.mark.parametrize(
    "change",
    [
        {"conflicts[1].gives_way": False},
        {"conflicts[1].path": 2},
        {"lane.station": ENTRY - FRONT + 0.1},  # its front is in it
        {"lane.station": ENTRY - FRONT - GAP - 100 / 2 / MOST + 0.5},  # it cannot stop any more
        {"tracks[1].id": 0},
        {"tracks[1].vy": -10.0},  # it goes away
        {"tracks[1].vy": 0.1},  # it stands
        {"tracks[1].x": -20.0},  # it passes elsewhere
    ],
)
def test_without_need_it_does_not_brake(new_part: NewPart, change: dict[str, float]) -> None:
    part = new(new_part, 10.0, 82.0)
    comes(part, 1.5)
    assert brakes(part)[1] == YIELD
    part = new(new_part, 10.0, 82.0)
    comes(part, 1.5)
    for name, value in change.items():
        part[name] = value
    assert brakes(part) == (0.0, NONE)


def test_those_ahead_who_drive_on_and_those_who_come_on_the_other_lane_are_no_concern(new_part: NewPart) -> None:
    part = new(new_part, 10.0, 82.0)
    comes(part, 1.5)
    part["tracks[1].x"], part["tracks[1].y"], part["tracks[1].vx"], part["tracks[1].vy"] = 10.0, 0.0, 8.0, 0.5
    assert brakes(part) == (0.0, NONE)
    part["tracks[1].x"], part["tracks[1].y"], part["tracks[1].vx"], part["tracks[1].vy"] = 40.0, 3.5, -10.0, 0.0
    assert brakes(part) == (0.0, NONE)


def test_it_stops_in_no_other_conflict(new_part: NewPart) -> None:
    part = new(new_part, 10.0, 76.0)
    part["conflicts[2].entry"], part["conflicts[2].exit"] = 96.5, 98.5
    comes(part, 2.0)
    assert brakes(part)[0] == pytest.approx(100 / 2 / (96.5 - GAP - FRONT - 76.0))


@pytest.mark.parametrize(("colour", "distance", "stops"), [
    ("red", 25.0, True), ("red", 2.0, False), ("green", 25.0, False), ("off", 25.0, False),
    ("yellow", FRONT + GAP + 100 / 6 + 0.1, True), ("yellow", FRONT + GAP + 100 / 6 - 0.1, False),
])  # fmt: skip
def test_lights(new_part: NewPart, colour: str, distance: float, stops: bool) -> None:
    part = new(new_part, 10.0, comfort_deceleration=2.0)
    part["light.colour"], part["light.distance"] = colour, distance
    assert brakes(part)[1] == (LIGHT if stops else NONE)
    if colour == "yellow" and not stops:  # a red that follows is driven past, too
        part["light.colour"], part["light.distance"] = "red", distance - 3.0
        assert brakes(part)[1] == NONE


def test_the_preview_tells_where_the_conflict_lies(new_part: NewPart) -> None:
    part = new(new_part, 10.0, 82.0)
    comes(part, 1.5)
    for i in range(24):  # the lane goes off to the left at once
        distance = 2.5 * (i + 1)
        part[f"preview[{i + 1}].distance"] = part[f"preview[{i + 1}].y"] = distance
    assert brakes(part) == (0.0, NONE)
