"""The rest of the world: the lead vehicle, and what the rays see of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

NewPart = Callable[..., Any]


def test_the_paper_case_starts_with_table_2(new_part: NewPart) -> None:
    part = new_part("straight_road")
    part.init()
    assert part["speed"] == 0
    assert part["gap"] == part["scene.range"] == 150.0
    assert part["closing_speed"] == part["scene.closing_speed"] == pytest.approx(-50 / 3.6, rel=1e-15)
    assert part["scene.hit"]
    assert not part["collision"]


def test_the_lead_keeps_its_speed_for_an_hour_without_drift(new_part: NewPart) -> None:
    part = new_part("straight_road", lead_speed=0.1, initial_gap=1.0)
    part.init()
    for _ in range(360_000):
        part.step()
    # Time is counted, not summed: exact to the rounding of one product and one sum.
    assert part["gap"] == pytest.approx(1.0 + 0.1 * 3600.0, rel=1e-15)


def test_the_lead_changes_its_speed_at_the_time_and_rate_set(new_part: NewPart) -> None:
    part = new_part(
        "straight_road", lead_speed=15.0, lead_change_time=2.005, lead_change_rate=3.0, lead_final_speed=6.0
    )
    part.init()
    for k in range(1, 801):
        part.step()
        t = k * 0.01
        since = min(max(t - 2.005, 0), 3.0)
        travelled = 15 * min(t, 2.005) + 15 * since - 1.5 * since**2 + 6 * max(t - 5.005, 0)
        assert part["lead.speed"] == pytest.approx(15 - 3 * since, rel=1e-12)
        assert part["gap"] == pytest.approx(150 + travelled, rel=1e-12)


def test_the_lead_can_also_speed_up(new_part: NewPart) -> None:
    part = new_part("straight_road", lead_speed=5.0, lead_change_time=1.0, lead_change_rate=2.0, lead_final_speed=9.0)
    part.init()
    for _ in range(400):
        part.step()
    assert part["lead.speed"] == 9.0
    assert part["gap"] == pytest.approx(150 + 5 * 1 + 7 * 2 + 9 * 1, rel=1e-12)


def test_time_stays_right_when_the_communication_step_changes(new_part: NewPart) -> None:
    part = new_part("straight_road", lead_speed=10.0)
    part.init()
    for h, count in ((0.01, 100), (0.02, 50), (0.005, 200)):
        for _ in range(count):
            part.step(h)
    assert part["gap"] == pytest.approx(150 + 10 * 3.0, rel=1e-14)


def test_contact_is_reported_and_stays_reported(new_part: NewPart) -> None:
    part = new_part("straight_road", initial_speed=20.0, lead_speed=0.0, initial_gap=10.0, lead_length=4.5)
    part.init()
    contact = None
    for k in range(1, 301):
        part.step()
        assert part["collision"] == (part["position"] >= 10.0)
        if part["collision"] and contact is None:
            contact = k
    assert contact == 51  # 10 m at 20 m/s take 0.5 s, rolling resistance a little more


def test_passing_a_car_in_the_next_lane_is_no_contact(new_part: NewPart) -> None:
    part = new_part("straight_road", initial_speed=20.0, lead_speed=0.0, initial_gap=10.0, lead_offset=3.5)
    part.init()
    for _ in range(200):
        part.step()
    assert part["gap"] < -20
    assert not part["collision"]


def nearest(near: float, length: float, offset: float, width: float, azimuths: list[float]) -> tuple[float, float]:
    """Range and azimuth of the nearest of all crossings of a ray with an edge of the box; inf if there is none."""
    corners = [(near, offset - width / 2), (near + length, offset - width / 2)]
    corners += [(near + length, offset + width / 2), (near, offset + width / 2)]
    best = (math.inf, 0.0)
    for azimuth in azimuths:
        dx, dy = math.cos(azimuth), math.sin(azimuth)
        for (x1, y1), (x2, y2) in zip(corners, corners[1:] + corners[:1], strict=True):
            # The corners' sides of the ray's line decide whether the edge crosses it.
            side1, side2 = dx * y1 - dy * x1, dx * y2 - dy * x2
            if side1 * side2 > 0 or side1 == side2:
                continue
            share = side1 / (side1 - side2)
            distance = dx * (x1 + share * (x2 - x1)) + dy * (y1 + share * (y2 - y1))
            if 0 <= distance < best[0] - 1e-12 * distance:
                best = (distance, azimuth)
    return best


@pytest.mark.thorough
def test_the_nearest_ray_hit_equals_exact_geometry(new_part: NewPart) -> None:
    part = new_part("straight_road")
    hits = []

    @settings(max_examples=400, deadline=None, derandomize=True)
    @given(
        gap=st.floats(0.3, 290),
        length=st.floats(0.5, 20),
        offset=st.floats(-8, 8),
        width=st.floats(0.3, 3),
        count=st.integers(1, 128),
        angle=st.floats(0.01, 2),
    )
    def check(gap: float, length: float, offset: float, width: float, count: int, angle: float) -> None:
        part["initial_gap"], part["lead_length"], part["lead_offset"], part["lead_width"] = gap, length, offset, width
        part["ray_count"], part["ray_angle"] = count, angle
        part["initial_speed"] = 20.0
        part.init()
        spacing = angle / (count - 1) if count > 1 else 0.0
        azimuths = [(i - (count - 1) / 2) * spacing for i in range(count)]
        distance, azimuth = nearest(gap, length, offset, width, azimuths)
        hits.append(distance <= 300)
        assert part["scene.hit"] == (distance <= 300)
        if distance <= 300:
            assert part["scene.range"] == pytest.approx(distance, rel=1e-9)
            # Two rays may see the same range to the last digits; then either azimuth is right.
            assert abs(part["scene.azimuth"]) == pytest.approx(abs(azimuth), abs=1e-9)
            assert part["scene.closing_speed"] == pytest.approx((20 - 50 / 3.6) * math.cos(azimuth), rel=1e-9)
        else:
            assert (part["scene.range"], part["scene.closing_speed"]) == (300.0, 0.0)

    check()
    assert 40 < sum(hits) < len(hits) - 40


def test_the_default_fan_finds_a_car_anywhere_in_the_lane_up_to_200_m(new_part: NewPart) -> None:
    part = new_part("straight_road")
    for gap in range(2, 201, 6):
        for offset in range(-10, 11):
            part["initial_gap"], part["lead_offset"] = float(gap), offset / 20
            part.init()
            assert part["scene.hit"]
            assert part["scene.range"] == pytest.approx(gap, rel=0.02)
