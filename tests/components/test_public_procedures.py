"""Emergency brakes in the cases of public test procedures, seen perfectly: engineering checks, no claim of conformity.

Euro NCAP AEB car to car (2023): 45 of a standing target, 55 of one at 20 km/h, 4 of one that brakes; overlaps 50, 75
and 100 %, on either side. UN R152: greatest impact speeds at a standing car. UN R157: when a cut-in has to be avoided.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest

NewPart = Callable[..., Any]
T, FRONT, WIDTH, MASS, RADIUS, KMH = 0.01, 2.1, 1.8, 1600.0, 0.31, 1 / 3.6
DEAD, LAG = 0.05, 0.1  # of the brake, assumed: what is demanded comes so much later
ROAD = 9.0  # m/s2: a dry road


def impact(
    part: Any, speed: float, gap: float, aside: float, lead: Callable[[float], tuple[float, float]], grip: float = ROAD
) -> float:
    """Speed over the target's at the collision, 0 if there is none; *lead* gives way and speed at a time."""
    way, acting, delayed = 0.0, 0.0, [0.0] * round(DEAD / T)
    part["motion.speed"] = speed
    part.init()
    for k in range(4000):
        along, other = lead(k * T)
        left = gap + along - way
        if left <= 0:
            return speed - other
        if speed == 0 or (k > 200 and left > 150):
            return 0.0
        part["motion.speed"], part["motion.acceleration"] = speed, -acting
        part["tracks[1].id"], part["tracks[1].class"], part["tracks[1].width"], part["tracks[1].age"] = (
            1, "car", WIDTH, 1.0,
        )  # fmt: skip
        part["tracks[1].x"], part["tracks[1].y"], part["tracks[1].vx"] = left + FRONT, aside, other
        part["tracks[1].existence"] = 1.0
        part.step(T)
        delayed.append(part["brake_torque"] / MASS / RADIUS)
        acting += (min(delayed.pop(0), grip) - acting) * -math.expm1(-T / LAG)
        way += max(speed - acting * T / 2, 0.0) * T
        speed = max(speed - acting * T, 0.0)
    return 0.0


def steady(speed: float) -> Callable[[float], tuple[float, float]]:
    return lambda time: (speed * time, speed)


def braking(speed: float, deceleration: float) -> Callable[[float], tuple[float, float]]:
    """From 1 s on."""

    def at(time: float) -> tuple[float, float]:
        since = min(max(time - 1.0, 0.0), speed / deceleration)
        return speed * (min(time, 1.0) + since) - deceleration * since**2 / 2, speed - deceleration * since

    return at


def ncap() -> Iterator[tuple[str, float, float, float, Callable[[float], tuple[float, float]]]]:
    """Name, own speed, gap at the start, where the target drives aside, how; 4 s before the collision to begin with."""
    for overlap in (-0.5, -0.75, 1.0, 0.75, 0.5):
        aside = math.copysign((1 - abs(overlap)) * WIDTH, overlap)
        for kmh in range(10, 51, 5):
            yield f"CCRs {kmh}", kmh * KMH, 4.0 * kmh * KMH, aside, steady(0.0)
        for kmh in range(30, 81, 5):
            yield f"CCRm {kmh}", kmh * KMH, 4.0 * (kmh - 20) * KMH, aside, steady(20 * KMH)
    for headway in (12.0, 40.0):
        for deceleration in (2.0, 6.0):
            yield f"CCRb {headway:g} {deceleration:g}", 50 * KMH, headway, 0.0, braking(50 * KMH, deceleration)


HIT: dict[str, tuple[int, dict[str, int]]] = {
    "two_stage_aeb": (2, {"CCRb 12 2": 4, "CCRb 12 6": 23}),
    "reference_driver_cc": (23, {"CCRs 50": 5, "CCRm 70": 8, "CCRm 75": 18, "CCRm 80": 26,
                                 "CCRb 12 2": 12, "CCRb 12 6": 32, "CCRb 40 2": 26}),
    "reference_driver_fsm": (0, {}),
    "reference_driver_rss": (0, {}),
}  # fmt: skip
"""How many of the 104 cases end in a collision; with how many km/h, whatever the overlap."""


@pytest.mark.thorough
@pytest.mark.parametrize("name", HIT)
def test_of_the_104_cases_of_euro_ncap_all_others_are_avoided(new_part: NewPart, name: str) -> None:
    cases = list(ncap())
    assert len(cases) == 104
    hits = [(case, impact(new_part(name), speed, gap, aside, lead)) for case, speed, gap, aside, lead in cases]
    found = [(case, round(hit / KMH)) for case, hit in hits if hit]
    assert (len(found), dict(found)) == HIT[name]


@pytest.mark.parametrize(("kmh", "most"), [(20, 0), (40, 0), (42, 10), (45, 15), (50, 25), (55, 30), (60, 35)])
def test_a_standing_car_is_hit_with_no_more_than_un_r152_allows(new_part: NewPart, kmh: int, most: int) -> None:
    """From full grip on a dry road down to 7 m/s2: none is hit at all."""
    for grip in (ROAD, 7.0):
        hit = impact(new_part("two_stage_aeb"), kmh * KMH, 4.0 * kmh * KMH, 0.0, steady(0.0), grip)
        assert hit <= most * KMH
        assert hit == 0


@pytest.mark.parametrize("closing", [3.0, 6.0, 10.0, 15.0, 20.0])
def test_a_cut_in_that_un_r157_wants_avoided_is_avoided(new_part: NewPart, closing: float) -> None:
    """The other's side comes into the car's way at a time to collision of closing/(2 6 m/s2) + 0.35 s."""
    gap, other = closing * (closing / 12 + 0.35), 10.0
    hits = {
        name: impact(new_part(name), other + closing, gap + 0.01, WIDTH - 0.01, steady(other))
        for name in ("two_stage_aeb", "reference_driver_cc", "reference_driver_fsm", "reference_driver_rss")
    }
    assert not hits.pop("two_stage_aeb")
    assert all(hits.values())  # people, who need 0.75 s
