"""The speed assistant against closed forms of braking, and before today's cruise controllers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

NewPart = Callable[..., Any]
T, POINTS, LATERAL, SLOWER, FRONT = 0.02, 24, 2.0, 1.5, 2.1  # start values
WISH, LIMIT, CURVE, LIGHT = range(4)
EXACT = {"lead_time": 0.0}


def see(part: Any, curvature: Callable[[float], float], station: float = 0.0, spacing: float = 4.0) -> None:
    part["lane.curvature"] = curvature(station)
    for i in range(POINTS):
        distance = (i + 1) * spacing
        part[f"preview[{i + 1}].distance"] = distance
        part[f"preview[{i + 1}].curvature"] = curvature(station + distance)


def straight(_: float) -> float:
    return 0.0


def new(new_part: NewPart, speed: float, wish: float = 40.0, **parameters: Any) -> Any:
    part = new_part("speed_assistant", **parameters)
    part["motion.speed"], part["wish"] = speed, wish
    see(part, straight)
    part["light.colour"] = "none"
    part.init()
    return part


def answer(part: Any) -> tuple[float, int]:
    part.step(T)
    return part["set_speed"], int(part["reason"])


def show(part: Any, colour: str, distance: float) -> None:
    part["light.colour"], part["light.distance"] = colour, distance


def test_with_nothing_ahead_the_wish_is_driven_and_a_negative_one_stands(new_part: NewPart) -> None:
    part = new(new_part, 20.0, 33.0)
    assert answer(part) == (33.0, WISH)
    part["wish"] = -1.0
    assert answer(part) == (0.0, WISH)


def test_the_limit_is_kept_from_its_sign_on_by_an_even_deceleration_and_left_at_once(new_part: NewPart) -> None:
    part = new(new_part, 30.0, 30.0)
    assert answer(part) == (30.0, WISH)
    part["lane.speed_limit"] = 25.0
    for tick in range(1, 300):
        speed, reason = answer(part)
        assert speed == pytest.approx(max(30.0 - SLOWER * T * tick, 25.0), rel=1e-12)
        assert reason == LIMIT
        part["motion.speed"] = speed + 0.5  # a controller that is late
    part["lane.speed_limit"] = 28.0
    assert answer(part) == (28.0, LIMIT)
    part["lane.speed_limit"] = 0.0
    assert answer(part) == (30.0, WISH)


def test_a_drive_that_begins_within_a_limit_keeps_it_from_the_start(new_part: NewPart) -> None:
    part = new_part("speed_assistant")
    part["wish"], part["motion.speed"], part["lane.speed_limit"] = 40.0, 25.0, 13.9
    part.init()
    assert (part["set_speed"], part["reason"]) == (13.9, LIMIT)


@pytest.mark.parametrize("curvature", [1 / 50, -1 / 120])
def test_on_a_bend_the_speed_is_that_of_its_lateral_acceleration(new_part: NewPart, curvature: float) -> None:
    part = new(new_part, 10.0)
    see(part, lambda _: curvature)
    assert answer(part) == (pytest.approx(math.sqrt(LATERAL / abs(curvature)), rel=1e-12), CURVE)


@pytest.mark.parametrize("lead", [0.0, 0.7])
@pytest.mark.parametrize(
    "knots",
    [
        (0.0, 0.0, 0.0, 0.02),
        (0.0, 0.001, 0.03, 0.0),
        (0.015, -0.03, 0.01, 0.0),
        (-0.002, -0.025, -0.004, 0.012),
        (0.0, 0.002, 0.004, 0.006),
        (0.03, 0.0, 0.0, -0.04),
    ],
)
def test_the_speed_towards_bends_is_the_least_that_any_point_ahead_allows(
    new_part: NewPart, knots: Sequence[float], lead: float
) -> None:
    """Against a search over 200,000 points of the same path."""
    speed, spacing = 13.0, 9.0
    part = new(new_part, speed, 200.0, lead_time=lead)
    along = spacing * np.arange(POINTS + 1)
    table = np.concatenate([knots, np.full(POINTS + 1 - len(knots), knots[-1])])
    see(part, lambda s: float(np.interp(s, along, table)), 0.0, spacing)
    places = np.concatenate([np.linspace(0.0, along[-1], 200_001), along, [speed * lead]])
    with np.errstate(divide="ignore"):
        allowed = LATERAL / np.abs(np.interp(places, along, table))
    allowed += 2 * SLOWER * np.maximum(places - speed * lead, 0.0)
    assert answer(part) == (pytest.approx(math.sqrt(allowed.min()), rel=1e-7), CURVE)


def test_braking_for_a_bend_begins_where_the_square_of_the_speed_says_and_ends_at_its_beginning(
    new_part: NewPart,
) -> None:
    """A car that has the set speed at once: v^2 = u^2 + 2 d D, even deceleration, the bend's speed at the bend."""
    wish, radius, bend = 20.0, 50.0, 100.0
    end = math.sqrt(LATERAL * radius)
    braking = (wish**2 - end**2) / (2 * SLOWER)
    part = new(new_part, wish, wish, **EXACT)
    station, speeds = 0.0, []
    while station < bend:
        part["motion.speed"] = speeds[-1][1] if speeds else wish
        # The bend begins at once: a point of the preview lies on it, and one an inch before.
        part["lane.curvature"] = 0.0
        for i in range(POINTS):
            distance = bend - station - 1e-9 if i == 0 else bend - station + (i - 1) * 4.0
            part[f"preview[{i + 1}].distance"] = distance
            part[f"preview[{i + 1}].curvature"] = 0.0 if i == 0 else 1 / radius
        speeds.append((station, answer(part)[0]))
        station += speeds[-1][1] * T
    began = next(s for s, speed in speeds if speed < wish)
    assert bend - began == pytest.approx(braking, abs=wish * T + 1e-6)
    falls = np.diff([speed for s, speed in speeds if s > began]) / T
    assert falls == pytest.approx(-SLOWER, rel=0.01)
    assert speeds[-1][1] == pytest.approx(end, abs=2 * SLOWER * T)


@pytest.mark.parametrize("kmh", [30, 50, 70])
@pytest.mark.parametrize("colour", ["red", "red_yellow"])
def test_a_red_light_is_stopped_at_with_the_bumper_at_its_gap(new_part: NewPart, kmh: int, colour: str) -> None:
    wish, start, gap = kmh / 3.6, 180.0, 1.5
    part = new(new_part, wish, wish, stop_gap=gap, **EXACT)
    station, speed, rows = 0.0, wish, []
    for tick in range(6000):
        show(part, colour, start - station)
        part["motion.speed"] = speed
        speed, reason = answer(part)
        rows.append((tick * T, station, speed, reason))
        if speed == 0:
            break
        station += speed * T
    assert start - station - FRONT == pytest.approx(gap, abs=0.01)
    began = next(row for row in rows if row[3] == LIGHT)
    braking = wish**2 / (2 * SLOWER)
    assert start - FRONT - gap - began[1] == pytest.approx(braking, abs=wish * T)
    assert rows[-1][0] - began[0] == pytest.approx(wish / SLOWER, abs=0.25)
    show(part, "green", start - station)
    assert answer(part) == (wish, WISH)


@pytest.mark.parametrize("lead", [0.0, 0.8])
def test_yellow_is_stopped_at_only_where_that_is_possible(new_part: NewPart, lead: float) -> None:
    speed = 14.0
    line = FRONT + 1.0 + speed * lead + speed**2 / (2 * 3.0)
    for distance, expected in [(line + 0.01, LIGHT), (line - 0.01, WISH)]:
        part = new(new_part, speed, 14.0, lead_time=lead)
        show(part, "green", distance + 0.3)
        assert answer(part) == (14.0, WISH)
        show(part, "yellow", distance)
        assert answer(part)[1] == expected
        # What has been decided holds: past a red that follows, and at one that comes sooner than the car stands.
        show(part, "red", distance - 0.3)
        assert answer(part)[1] == expected
        show(part, "red", 80.0)  # the next one
        assert answer(part)[1] == WISH  # still far
        show(part, "red", 6.0)
        assert answer(part)[1] == LIGHT


def test_a_car_that_rolls_beyond_its_gap_stands_until_green(new_part: NewPart) -> None:
    part = new(new_part, 3.0, 14.0)
    show(part, "red", 6.0)
    assert answer(part)[1] == LIGHT
    for distance in (3.0, 2.0, 1.0):  # the bumper is past the line at the end
        show(part, "red", distance)
        assert answer(part) == (0.0, LIGHT)
    show(part, "red_yellow", 1.0)
    assert answer(part) == (0.0, LIGHT)
    show(part, "green", 1.0)
    assert answer(part) == (14.0, WISH)


@pytest.mark.parametrize("colour", ["none", "off", "green"])
def test_other_lights_are_driven_past(new_part: NewPart, colour: str) -> None:
    part = new(new_part, 14.0, 14.0)
    show(part, colour, 5.0)
    assert answer(part) == (14.0, WISH)


def test_what_is_least_counts_and_is_named(new_part: NewPart) -> None:
    part = new_part("speed_assistant", **EXACT)
    part["wish"], part["motion.speed"], part["lane.speed_limit"] = 30.0, 10.0, 20.0
    see(part, lambda _: 1 / 50)
    show(part, "red", FRONT + 1.0 + 12.0)
    part.init()
    assert (part["set_speed"], part["reason"]) == (pytest.approx(math.sqrt(2 * SLOWER * 12.0)), LIGHT)
    show(part, "green", 10.0)
    assert answer(part) == (pytest.approx(10.0), CURVE)
    see(part, straight)
    assert answer(part) == (20.0, LIMIT)


def drive(new_part: NewPart, name: str, lead: float) -> tuple[float, float]:
    """Through a bend between spirals and to a red light: the worst lateral acceleration, what is left to the light."""
    mass, wheel = 1600.0, 0.31
    assistant, acc = new(new_part, 15.0, 18.0, lead_time=lead), new_part(name)
    station, speed, light, worst, fastest = 0.0, 15.0, 400.0, 0.0, 0.0

    def curvature(s: float) -> float:
        return float(np.interp(s, [120.0, 150.0, 200.0, 230.0], [0.0, 1 / 50, 1 / 50, 0.0]))

    for tick in range(8000):
        if tick % 2 == 0:
            assistant["motion.speed"] = speed
            see(assistant, curvature, station)
            show(assistant, "red", light - station)
            assistant.step(T)
        acc["speed"], acc["set_speed"] = speed, assistant["set_speed"]
        if tick == 0:
            acc.init()
        acc.step(0.01)
        force = (acc["demand.drive_torque"] - acc["demand.brake_torque"]) / wheel
        force -= 0.5 * 1.2 * 0.65 * speed**2 + (0.01 * mass * 9.81 if speed > 0 else 0)
        speed = max(speed + force / mass * 0.01, 0.0)
        station += speed * 0.01
        worst, fastest = max(worst, speed**2 * curvature(station)), max(fastest, speed)
        if speed < 0.01 and assistant["set_speed"] < 0.01:
            break
    assert speed < 0.01
    assert fastest > 16
    return worst, light - FRONT - station


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "kp"), [("pd_acc", 1.2), ("pi_time_gap_acc", 0.7)])
def test_before_todays_cruise_controllers_the_lead_time_takes_up_their_lag(
    new_part: NewPart, name: str, kp: float
) -> None:
    late, soon, sooner = (drive(new_part, name, times / kp) for times in (0, 1, 2))
    assert late[0] > soon[0] > sooner[0]
    assert 1.8 < sooner[0] < 1.1 * LATERAL
    assert late[1] < 0  # over the line
    assert 0 < soon[1] < 3
    assert 0 < sooner[1] < 3
