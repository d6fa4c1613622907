"""Which track a cruise control follows, against the exact geometry of straight and circular lanes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

NewPart = Callable[..., Any]
RADII = [math.inf, 200.0, -120.0]  # > 0: to the left
WIDTH = 3.5


def on_lane(radius: float, station: float, offset: float) -> tuple[float, float, float]:
    """Position and direction of a place of the lane, whose middle starts at the origin along x."""
    if math.isinf(radius):
        return station, offset, 0.0
    turn = station / radius
    return (radius - offset) * math.sin(turn), radius - (radius - offset) * math.cos(turn), turn


def stand(part: Any, radius: float, offset: float = 0.0, turn: float = 0.0, speed: float = 20.0) -> None:
    """A host beside the origin, and its preview: every 4 m up to 96 m."""
    part["lane.offset"], part["lane.heading"], part["lane.width"] = offset, turn, WIDTH
    part["lane.curvature"], part["motion.speed"], part["lane.on_road"] = 1 / radius, speed, True
    for i in range(1, 25):
        x, y, heading = on_lane(radius, 4.0 * i, 0.0)
        x, y = seen((x, y), offset, turn)
        values = {"distance": 4.0 * i, "x": x, "y": y, "heading": heading - turn, "curvature": 1 / radius}
        for key, value in values.items():
            part[f"preview[{i}].{key}"] = value


def seen(point: tuple[float, float], offset: float, turn: float) -> tuple[float, float]:
    dx, dy = point[0], point[1] - offset
    return dx * math.cos(turn) + dy * math.sin(turn), dy * math.cos(turn) - dx * math.sin(turn)


def track(
    part: Any, number: int, radius: float, station: float, aside: float = 0.0, speed: float = 0.0, *,
    offset: float = 0.0, turn: float = 0.0,
) -> None:  # fmt: skip
    """One that drives along the lane *aside* of its middle, seen from the host."""
    x, y, heading = on_lane(radius, station, aside)
    part[f"tracks[{number}].id"] = number
    part[f"tracks[{number}].x"], part[f"tracks[{number}].y"] = seen((x, y), offset, turn)
    part[f"tracks[{number}].vx"] = speed * math.cos(heading - turn)
    part[f"tracks[{number}].vy"] = speed * math.sin(heading - turn)


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("station", [6.0, 41.3, 95.0])
def test_gap_and_closing_speed_are_those_along_the_curved_middle(
    new_part: NewPart, radius: float, station: float
) -> None:
    part = new_part("lane_target", host_front=2.0)
    offset, turn, aside = 0.4, 0.03, -0.7
    stand(part, radius, offset, turn)
    track(part, 2, radius, station, aside, speed=12.0, offset=offset, turn=turn)
    part.init()
    assert part["target.detected"]
    assert part["target.gap"] == pytest.approx(station - 2.0, abs=1e-5)
    # A foot goes as much faster than the car as the middle's radius is larger than the car's own.
    own, other = (math.cos(turn) * 20.0 / (1 - offset / radius), 12.0 / (1 - aside / radius))
    assert part["target.closing_speed"] == pytest.approx(own - other, abs=1e-5)


def test_beyond_the_preview_the_lane_goes_straight_on(new_part: NewPart) -> None:
    part = new_part("lane_target", host_front=2.0)
    stand(part, 200.0)
    end_x, end_y, heading = on_lane(200.0, 96.0, 0.0)
    part["tracks[1].id"] = 1
    part["tracks[1].x"], part["tracks[1].y"] = end_x + 50 * math.cos(heading), end_y + 50 * math.sin(heading)
    part.init()
    assert part["target.gap"] == pytest.approx(96 + 50 - 2, abs=1e-5)
    assert part["target.closing_speed"] == pytest.approx(20.0, abs=1e-9)


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("side", [-1, 1])
def test_one_is_in_the_lane_up_to_its_borders_however_it_bends(new_part: NewPart, radius: float, side: int) -> None:
    part = new_part("lane_target")
    stand(part, radius)
    for aside, followed in ((0.999 * WIDTH / 2, True), (1.001 * WIDTH / 2, False)):
        track(part, 1, radius, 60.0, side * aside)
        part.init()
        assert part["target.detected"] == followed


def test_the_nearest_in_the_lane_is_followed_whatever_drives_beside_and_behind(new_part: NewPart) -> None:
    part = new_part("lane_target", host_front=2.0)
    stand(part, 200.0)
    for number, (station, aside) in enumerate([(70.0, 0.0), (50.0, 0.5), (20.0, 3.5), (15.0, -3.5), (-10.0, 0.0)], 1):
        track(part, number, 200.0, station, aside)
    part.init()
    assert part["target.gap"] == pytest.approx(48.0, abs=1e-5)
    part["tracks[2].id"] = 0
    part.step()
    assert part["target.gap"] == pytest.approx(68.0, abs=1e-5)


def test_who_is_followed_is_kept_a_little_beyond_the_border(new_part: NewPart) -> None:
    part = new_part("lane_target", hold=0.1)
    stand(part, math.inf)
    states: list[bool] = []
    for aside in (1.85, 1.7, 1.85, 1.95, 1.85):  # the border is at 1.75, that of who is followed at 1.925
        track(part, 1, math.inf, 40.0, aside)
        part.init() if not states else part.step()
        states.append(part["target.detected"])
    assert states == [False, True, True, False, False]


def test_a_lost_target_keeps_its_last_gap_and_says_it_is_not_detected(new_part: NewPart) -> None:
    part = new_part("lane_target", host_front=2.0)
    stand(part, math.inf)
    track(part, 1, math.inf, 40.0, speed=15.0)
    part.init()
    part["tracks[1].id"] = 0
    part.step()
    assert not part["target.detected"]
    assert [part["target.gap"], part["target.closing_speed"]] == pytest.approx([38.0, 5.0], abs=1e-6)


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("side", [-1, 1])
def test_who_will_be_in_the_lane_within_the_horizon_is_followed_already(
    new_part: NewPart, radius: float, side: int
) -> None:
    """From the middle of the next lane to the border are half a lane's width, however the lane bends."""
    part = new_part("cut_in_target", horizon=1.0)
    stand(part, radius)
    for share, followed in ((1.01, True), (0.99, False), (-1.0, False)):
        track(part, 1, radius, 40.0, side * WIDTH, speed=20.0)
        _, _, heading = on_lane(radius, 40.0, 0.0)
        across = -side * share * WIDTH / 2
        part["tracks[1].vx"] -= across * math.sin(heading)
        part["tracks[1].vy"] += across * math.cos(heading)
        part.init()
        assert part["target.detected"] == followed


def test_who_crosses_the_lane_within_the_horizon_is_followed_too(new_part: NewPart) -> None:
    part = new_part("cut_in_target", horizon=1.0)
    stand(part, math.inf)
    track(part, 1, math.inf, 40.0, 4.0)
    part["tracks[1].vy"] = -20.0  # on the other side long before the horizon
    part.init()
    assert part["target.detected"]
