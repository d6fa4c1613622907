"""Braking at walking speed against boxes step by step; the retention of doors against the times of its parameters."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

NewPart = Callable[..., Any]
Place = tuple[float, float, float, float]
FRONT, LENGTH, WIDTH = 2.3, 4.5, 1.8
SIZES = {"car": (4.5, 1.8), "motorcycle": (2.1, 0.8), "bicycle": (1.9, 0.6), "pedestrian": (0.0, 0.5)}


def see(part: Any, x: float, y: float, vx: float, vy: float, kind: str = "none", **more: float) -> None:
    for key, value in {"id": 1, "age": 1.0, "existence": 1.0, "x": x, "y": y, "vx": vx, "vy": vy, **more}.items():
        part[f"tracks[1].{key}"] = value
    part["tracks[1].class"] = kind


def brakes(part: Any, speed: float, *track: Any, acceleration: float = 0.0, **more: float) -> bool:
    part["motion.speed"], part["motion.acceleration"] = speed, acceleration
    part.init()
    see(part, *track, **more)
    part.step()
    return bool(part["stage"] > 0)


def strip(speed: float, acceleration: float = 0.0) -> float:
    """Its length: 0.3 s of lost time, 6 m/s2, 0.4 m."""
    ends = speed + 0.3 * acceleration
    return 0.3 * (speed + ends) / 2 + ends**2 / 12 + 0.4


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("acceleration", [0.0, 1.5])
def test_it_brakes_for_what_stands_in_its_way_and_not_for_what_is_beside(
    new_part: NewPart, sense: int, acceleration: float
) -> None:
    part = new_part("manoeuvre_aeb")
    for kind, width in (("pedestrian", 0.5), ("none", 1.0)):
        for speed, out in itertools.product((0.5, 1.5, 3.0), (-0.01, 0.01)):
            ahead = strip(speed, acceleration) + (FRONT if sense > 0 else LENGTH - FRONT)
            moving = {"acceleration": sense * acceleration}
            assert brakes(part, sense * speed, sense * (ahead + out), 0.0, 0.0, 0.0, kind, **moving) == (out < 0)
            aside = WIDTH / 2 + 0.2 + width / 2
            assert brakes(part, sense * speed, sense * (ahead - 0.1), aside + out, 0.0, 0.0, kind, **moving) == (
                out < 0
            )
            assert not brakes(part, sense * speed, -sense * ahead, 0.0, 0.0, 0.0, kind, **moving)  # behind it


def meets(place: Place, half: tuple[float, float], speed: float, more: float, time: float) -> bool:
    """Whether a box of *half* the extents along and across is in the strip by *time*; *more* metres on all sides."""
    x, y, vx, vy = place
    times = np.arange(0, time, 1e-3)
    ahead, beside = x - FRONT + vx * times, np.abs(y + vy * times)
    is_ahead = (ahead > -half[0] - more) & (ahead < strip(speed) + half[0] + more)
    return bool(np.any(is_ahead & (beside < WIDTH / 2 + 0.2 + half[1] + more)))


@pytest.mark.parametrize("kind", SIZES)
def test_it_brakes_for_what_will_be_in_its_way_within_the_horizon(new_part: NewPart, kind: str) -> None:
    """A box that moves, step by step; a case within a step or a centimetre of the limit is left out."""
    part, random = new_part("manoeuvre_aeb"), np.random.default_rng(2)
    (length, width), speed, found = SIZES[kind], 1.2, set()
    for _ in range(300):
        x, y, vx, vy = random.uniform([-8, -12, -6, -6], [12, 12, 6, 6])
        pace = math.hypot(vx, vy)
        if pace < 0.6:
            continue
        half = tuple((abs(a) * length + abs(b) * width) / pace / 2 for a, b in ((vx, vy), (vy, vx)))
        case = (x, y, vx, vy), half, speed
        if meets(*case, -0.01, 2.49) != meets(*case, 0.01, 2.51):
            continue
        expected = meets(*case, 0.0, 2.5)
        found.add(expected)
        assert brakes(part, speed, x, y, vx, vy, kind) == expected
    assert found == {True, False}


def test_it_acts_at_walking_speed_for_sure_tracks_and_holds_the_car(new_part: NewPart) -> None:
    part, child = new_part("manoeuvre_aeb"), (2.6, 0.0, 0.0, 0.0, "pedestrian")
    assert brakes(part, 4.0, *child)
    assert not brakes(part, 4.3, *child)
    assert not brakes(part, 0.0, *child)
    assert not brakes(part, 1.0, *child, age=0.1)
    assert not brakes(part, 1.0, *child, existence=0.8)
    assert brakes(part, 1.0, *child)
    for _ in range(9):
        part.step()
    assert part["deceleration"] == pytest.approx(6.0)  # 60 m/s3
    assert part["brake_torque"] == pytest.approx(1600 * 0.31 * 6.0)
    part["motion.speed"] = 0.0
    for _ in range(50):
        part.step()
    part["tracks[1].id"] = 0
    held = 0
    while part["stage"] > 0:
        part.step()
        held += 1
    assert held == 200


@pytest.mark.parametrize("side", [1, -1])
def test_doors_are_shut_from_the_horizon_until_the_road_user_has_passed(new_part: NewPart, side: int) -> None:
    for speed, gap in itertools.product((10 / 3.6, 20 / 3.6), (0.5, 2.0)):
        part = new_part("door_retention")
        part.init()
        shut = []
        for k in range(1, 601):
            time = 0.02 * k - 6  # to the door, and after it
            see(part, -0.2 + speed * time, side * (WIDTH / 2 + gap), speed, 0.0)
            part.step()
            if part["retained"]:
                shut.append(time)
        assert shut[0] == pytest.approx(-3, abs=0.021)
        assert shut[-1] == pytest.approx(2.5 / speed + 0.5, abs=0.021)
        assert len(shut) == round((shut[-1] - shut[0]) / 0.02) + 1


def test_doors_are_free_without_danger_and_while_the_car_moves(new_part: NewPart) -> None:
    def shut(speed: float = 0.0, **track: float) -> bool:
        part = new_part("door_retention")
        part["motion.speed"] = speed
        part.init()
        see(part, **{"x": -8.0, "y": 1.5, "vx": 4.0, "vy": 0.0, **track})  # type: ignore[arg-type]
        part.step()
        return bool(part["retained"])

    assert shut()
    for free in ({"y": 3.5}, {"y": 0.3}, {"vx": 0.5}, {"vx": -4.0}, {"age": 0.1}, {"existence": 0.5}, {"id": 0}):
        assert not shut(**free)
    assert not shut(speed=1.0)
