"""A low sun before cameras, and the camera that reads traffic lights, against their formulas."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

NewPart = Callable[..., Any]
GREEN = "green"


def veil(degrees: float, glare: float) -> float:
    """Stiles and Holladay: 10 E / (L theta^2), E on what faces the way one looks."""
    return 10 * glare * math.cos(math.radians(degrees)) / degrees**2


def dazzled(part: Any, azimuth: float, elevation: float, glare: float) -> None:
    part["sun.azimuth"], part["sun.elevation"], part["sun.glare"] = (
        math.radians(azimuth),
        math.radians(elevation),
        glare,
    )


@pytest.mark.parametrize(
    ("azimuth", "elevation", "heading", "degrees"),
    [(0, 20, 0, 20), (110, 0, 90, 20), (-25, 0, 0, 25), (180, 10, 0, None)],
)
def test_a_camera_sees_less_far_against_the_sun_by_what_it_scatters(
    new_part: NewPart, azimuth: float, elevation: float, heading: float, degrees: float | None
) -> None:
    part = new_part("object_camera", mount=0.0, dropout=0.0, range_noise=0.0, relative_noise=0.0, azimuth_noise=0.0)
    part["motion.heading"] = math.radians(heading)
    part["visibility.fog_extinction"] = 0.05
    dazzled(part, azimuth, elevation, 16.0)
    reach = -math.log(0.05 * (1 + (veil(degrees, 16.0) if degrees else 0.0))) / 0.05
    for share, found in ((1 - 1e-9, True), (1 + 1e-9, False)):
        distance = reach * share + 2.0
        for name, value in {"id": 1, "class": "car", "length": 4.0, "width": 2.0, "height": 1.5}.items():
            part[f"actors[1].{name}"] = value
        part["actors[1].x"] = distance * math.cos(math.radians(heading))
        part["actors[1].y"] = distance * math.sin(math.radians(heading))
        part["actors[1].heading"] = math.radians(heading)
        part.init()
        for _ in range(30):
            part.step()
        assert part["scan.returns[1].valid"] == found


def test_radars_and_lidars_do_not_mind_the_sun(new_part: NewPart) -> None:
    for name in ("object_radar_mid", "object_lidar"):
        told = []
        for glare in (0.0, 500.0):
            part = new_part(name)
            for key, value in {"id": 1, "class": "car", "length": 4.0, "width": 2.0, "height": 1.5, "x": 30.0}.items():
                part[f"actors[1].{key}"] = value
            dazzled(part, 0.0, 5.0, glare)
            part.init()
            for _ in range(30):
                part.step()
            told.append([part[f"scan.returns[1].{key}"] for key in ("valid", "range", "azimuth", "strength")])
        assert told[0] == told[1]
        assert told[0][0]


@pytest.mark.parametrize(("degrees", "is_seen"), [(2.0, False), (3.5, True)])
def test_a_lane_is_lost_where_the_sun_stands_over_it(new_part: NewPart, degrees: float, is_seen: bool) -> None:
    part = new_part("lane_camera", dropout=0.0)
    for number in range(24):
        part[f"preview[{number + 1}].distance"] = part[f"preview[{number + 1}].x"] = 2.5 * (number + 1)
    dazzled(part, 0.0, degrees, 16.0)
    part.init()
    for _ in range(30):
        part.step()
    # Of a contrast of 1 is left 1 / (1 + veil): 0.024 at 2 degrees, 0.071 at 3.5; seen are 0.05.
    assert (1 / (1 + veil(degrees, 16.0)) > 0.05) is is_seen
    assert bool(part["seen.valid"]) is is_seen


def camera(new_part: NewPart, **parameters: Any) -> Any:
    part = new_part(
        "light_camera", **{"dropout": 0.0, "distance_error": 0.0, "period": 0.05, "latency": 0.1, **parameters}
    )
    part["motion.speed"] = 10.0
    return part


def test_a_light_is_told_a_latency_after_each_look_with_the_way_driven_since(new_part: NewPart) -> None:
    part = camera(new_part)
    part["light.distance"], part["light.colour"] = 50.0, "red"
    part.init()
    assert part["seen.colour"] == 0
    for tick in range(1, 60):
        part["light.distance"] = 50.0 - 0.1 * tick
        part["light.colour"] = "red" if tick < 20 else GREEN
        part.step()
        if tick < 10:
            assert part["seen.colour"] == 0
            continue
        looked = 5 * ((tick - 10) // 5)
        assert part["seen.colour"] == (2 if looked < 20 else 5)
        assert part["seen.distance"] == pytest.approx(50.0 - 0.1 * tick, abs=1e-9)
        assert part["seen.remaining"] == 0


@pytest.mark.parametrize(
    ("weather", "sun", "reach"),
    [
        ({}, 0.0, 60.0),
        ({"darkness": 1.0}, 0.0, 60.0),
        ({"fog_extinction": 0.1}, 0.0, -math.log(0.05) / 0.1),
        ({"fog_extinction": 0.1}, 16.0, -math.log(0.05 * (1 + veil(20.0, 16.0))) / 0.1),
    ],
)
def test_a_light_is_seen_as_far_as_its_lamp_has_contrast(
    new_part: NewPart, weather: dict[str, float], sun: float, reach: float
) -> None:
    for share, colour in ((1 - 1e-9, 5), (1 + 1e-9, 0)):
        part = camera(new_part, latency=0.0)
        for name, value in weather.items():
            part[f"visibility.{name}"] = value
        dazzled(part, 20.0, 0.0, sun)
        part["light.distance"], part["light.colour"] = reach * share, GREEN
        part.init()
        assert part["seen.colour"] == colour


def test_lights_are_missed_and_misjudged_as_often_and_as_much_as_asked_for(new_part: NewPart) -> None:
    part = camera(new_part, dropout=0.2, distance_error=0.05, period=0.01, latency=0.0)
    part["motion.speed"] = 0.0
    part["light.distance"], part["light.colour"] = 40.0, GREEN
    part.init()
    told = []
    for _ in range(20_000):
        part.step()
        told.append(part["seen.distance"] if part["seen.colour"] else None)
    found = [distance for distance in told if distance is not None]
    mean = sum(found) / len(found)
    spread = math.sqrt(sum((distance - mean) ** 2 for distance in found) / len(found))
    # Five standard deviations of the share, the mean and the spread.
    assert 1 - len(found) / len(told) == pytest.approx(0.2, abs=5 * math.sqrt(0.16 / len(told)))
    assert mean == pytest.approx(40.0, abs=5 * 2.0 / math.sqrt(len(found)))
    assert spread == pytest.approx(2.0, rel=5 / math.sqrt(2 * len(found)))
