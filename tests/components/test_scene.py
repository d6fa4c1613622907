"""The rays and the truth of a scene, against geometry that is done another way."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

NewPart = Callable[..., Any]
Point = tuple[float, float]


def place(part: Any, number: int, x: float, y: float, heading: float = 0.0, **values: float) -> None:
    values = {"class": "car", "id": number, "length": 4.5, "width": 1.8, "x": x, "y": y, "heading": heading} | values
    for name, value in values.items():
        part[f"actors[{number}].{name}"] = value


def corners(x: float, y: float, heading: float, length: float, width: float) -> list[Point]:
    c, s = math.cos(heading), math.sin(heading)
    ends = [(-length, -width), (length, -width), (length, width), (-length, width)]
    return [(x + (a * c - b * s) / 2, y + (a * s + b * c) / 2) for a, b in ends]


def crossing(origin: Point, azimuth: float, a: Point, b: Point) -> float:
    """How far along the ray it crosses the segment; inf if it does not (the corners' sides of the ray decide)."""
    dx, dy = math.cos(azimuth), math.sin(azimuth)
    (ax, ay), (bx, by) = ((p[0] - origin[0], p[1] - origin[1]) for p in (a, b))
    side_a, side_b = dx * ay - dy * ax, dx * by - dy * bx
    if side_a * side_b > 0 or side_a == side_b:
        return math.inf
    share = side_a / (side_a - side_b)
    distance = dx * (ax + share * (bx - ax)) + dy * (ay + share * (by - ay))
    return distance if distance >= 0 else math.inf


def is_inside(p: Point, box: list[Point]) -> bool:
    edges = zip(box, box[1:] + box[:1], strict=True)
    return all((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) >= 0 for a, b in edges)


pose = st.tuples(st.floats(-30, 120), st.floats(-30, 30), st.floats(-4, 4), st.floats(0.5, 15), st.floats(0.3, 3))


@pytest.mark.parametrize("heading", [0.0, 5e-324, 1e-310, 1e-250, -5e-324])
def test_a_box_that_is_as_good_as_parallel_to_the_ray_beside_it_is_not_hit(new_part: NewPart, heading: float) -> None:
    part = new_part("ray_scanner", host_front=2.0, ray_count=1)
    place(part, 1, 0.0, 1.0, heading, length=4.0, width=1.0)
    part.init()
    assert not part["scene.hit"]


@pytest.mark.thorough
def test_the_nearest_hit_of_many_boxes_equals_exact_geometry(new_part: NewPart) -> None:
    part = new_part("ray_scanner", host_front=2.0)
    hits = []

    @settings(max_examples=500, deadline=None, derandomize=True)
    @given(
        boxes=st.lists(pose, min_size=1, max_size=8), host=st.tuples(*[st.floats(-4, 4)] * 3),
        count=st.integers(1, 128), angle=st.floats(0.01, 2.9), motion=st.tuples(*[st.floats(-30, 30)] * 5),
    )  # fmt: skip
    def check(boxes: Any, host: Any, count: int, angle: float, motion: Any) -> None:
        x, y, heading = host
        speed, aside, yaw, other_speed, other_aside = motion
        for number in range(1, 9):
            part[f"actors[{number}].class"] = "none"
        for number, (bx, by, turn, length, width) in enumerate(boxes, 1):
            place(part, number, bx, by, turn, length=length, width=width, speed=other_speed, lateral_speed=other_aside)
        part["motion.x"], part["motion.y"], part["motion.heading"] = host
        part["motion.speed"], part["motion.lateral_speed"], part["motion.yaw_rate"] = speed, aside, yaw
        part["ray_count"], part["ray_angle"] = count, angle
        part.init()
        origin = x + 2 * math.cos(heading), y + 2 * math.sin(heading)
        spacing = angle / (count - 1) if count > 1 else 0.0
        best, which, ray = 300.0, None, 0.0
        for number, (bx, by, turn, length, width) in enumerate(boxes):
            box = corners(bx, by, turn, length, width)
            for i in range(count):
                azimuth = (i - (count - 1) / 2) * spacing
                far = min(
                    crossing(origin, heading + azimuth, a, b) for a, b in zip(box, box[1:] + box[:1], strict=True)
                )
                far = 0.0 if is_inside(origin, box) else far
                if far < best - 1e-9:
                    best, which, ray = far, number, azimuth
        hits.append(which is not None)
        if which is None:
            assert not part["scene.hit"] or part["scene.range"] > 299.999
            return
        assert part["scene.range"] == pytest.approx(best, abs=1e-7)
        if best > 0.01:
            # Two rays may see the same range to the last digits; Doppler is that of the ray reported.
            ray = part["scene.azimuth"]
            towards = np.array([math.cos(heading + ray), math.sin(heading + ray)])
            own = rotated(heading, speed, aside + 2 * yaw)
            found = {round(float(-(rotated(turn, other_speed, other_aside) - own) @ towards), 6)
                     for _, _, turn, _, _ in boxes}  # fmt: skip
            assert any(abs(part["scene.closing_speed"] - each) < 2e-6 for each in found)

    check()
    assert sum(hits) > 100
    assert len(hits) - sum(hits) > 20


def rotated(angle: float, x: float, y: float) -> Any:
    return np.array([x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)])


def test_on_a_straight_road_it_sees_what_straight_road_sees(new_part: NewPart) -> None:
    both = {"ray_count": 121, "ray_angle": math.radians(60)}
    for gap, offset in ((150.0, 0.0), (40.0, 0.7), (12.0, -1.5), (280.0, 0.0), (90.0, 3.0)):
        old = new_part("straight_road", initial_gap=gap, lead_offset=offset, initial_speed=20.0, **both)
        old.init()
        part = new_part("ray_scanner", host_front=2.3, **both)
        part["motion.speed"], part["lane.width"] = 20.0, 10.0
        place(part, 3, 2.3 + gap + 2.25, offset, speed=50 / 3.6, ahead=2.3 + gap + 2.25, aside=offset,
              approach=20 - 50 / 3.6)  # fmt: skip
        part.init()
        for port in ("scene.range", "scene.azimuth", "scene.closing_speed", "scene.hit", "gap", "closing_speed"):
            assert part[port] == pytest.approx(old[port], rel=1e-12, abs=1e-12)
        assert (part["lead.speed"], part["lead.id"]) == (50 / 3.6, 3)


def test_the_lead_is_the_nearest_ahead_in_the_hosts_lane(new_part: NewPart) -> None:
    part = new_part("ray_scanner")
    part["lane.width"] = 3.5
    for number, (ahead, aside) in enumerate([(60.0, 0.2), (25.0, 3.5), (-15.0, 0.0), (40.0, -1.7), (30.0, -1.8)], 1):
        place(part, number, ahead, aside, ahead=ahead, aside=aside, speed=number, approach=-number)
    part.init()
    assert part["lead.id"] == 4
    assert part["gap"] == pytest.approx(40 - 2.3 - 2.25, rel=1e-15)
    assert (part["closing_speed"], part["lead.speed"]) == (-4, 4)
    part["actors[1].class"] = part["actors[4].class"] = "none"
    part.step()
    assert (part["lead.id"], part["gap"], part["closing_speed"], part["lead.speed"]) == (0, 300, 0, 0)


def test_boxes_collide_if_and_only_if_they_overlap(new_part: NewPart) -> None:
    part = new_part("ray_scanner", host_front=2.5, host_length=5.0, host_width=2.0)
    found = []

    @settings(max_examples=500, deadline=None, derandomize=True)
    @given(x=st.floats(-8, 8), y=st.floats(-6, 6), turn=st.floats(-4, 4), length=st.floats(0.5, 8),
           width=st.floats(0.3, 3))  # fmt: skip
    def check(x: float, y: float, turn: float, length: float, width: float) -> None:
        place(part, 1, x, y, turn, length=length, width=width)
        part.init()
        host, other = corners(0, 0, 0, 5, 2), corners(x, y, turn, length, width)
        clip = clipped(other, host)
        overlap = abs(area(clip)) if len(clip) > 2 else 0.0
        found.append(part["collision"])
        assert part["collision"] == (overlap > 0) or overlap < 1e-9

    check()
    assert 50 < sum(found) < len(found) - 50


def clipped(polygon: list[Point], window: list[Point]) -> list[Point]:
    """What of *polygon* lies in the convex *window* (Sutherland and Hodgman)."""
    for a, b in zip(window, window[1:] + window[:1], strict=True):
        sides = [(b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) for p in polygon]
        kept: list[Point] = []
        for i, (p, side) in enumerate(zip(polygon, sides, strict=True)):
            q, other = polygon[i - 1], sides[i - 1]
            if (side >= 0) != (other >= 0):
                share = other / (other - side)
                kept.append((q[0] + share * (p[0] - q[0]), q[1] + share * (p[1] - q[1])))
            if side >= 0:
                kept.append(p)
        polygon = kept
    return polygon


def area(polygon: list[Point]) -> float:
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True)) / 2


def test_a_collision_stays_reported(new_part: NewPart) -> None:
    part = new_part("ray_scanner")
    place(part, 1, 20.0, 0.0)
    part.init()
    assert not part["collision"]
    place(part, 1, 4.0, 0.0)
    part.step()
    assert part["collision"]
    place(part, 1, 20.0, 0.0)
    part.step()
    assert part["collision"]


@pytest.mark.parametrize(("height", "clearance", "hits"), [(1.5, 0.0, True), (0.02, 0.0, False), (6.0, 4.5, False)])
def test_a_car_passes_under_a_bridge_and_over_a_manhole_cover(
    new_part: NewPart, height: float, clearance: float, hits: bool
) -> None:
    part = new_part("ray_scanner")
    for key, value in {"class": 6, "length": 2.0, "width": 20.0, "height": height, "clearance": clearance}.items():
        part[f"actors[1].{key}"] = value
    part["actors[1].x"] = part["actors[1].ahead"] = 3.0
    part["lane.width"] = 3.5
    part.init()
    part.step()
    assert (part["collision"], part["scene.hit"], part["lead.id"] == 0 and part["gap"] < 300) == (hits, hits, hits)
