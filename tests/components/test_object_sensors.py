"""Object sensors against geometry done another way, closed forms of their physics, and statistics of their noise."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray

NewPart = Callable[..., Any]
Point = tuple[float, float]
SENSORS = [
    "object_radar_long", "object_radar_mid", "object_lidar", "object_lidar_roof", "object_camera", "object_stereo",
    "object_perfect",
]  # fmt: skip
DEVIATIONS = ("range_deviation", "azimuth_deviation", "rate_deviation")
CLEAN: dict[str, Any] = {
    "range_noise": 0.0, "relative_noise": 0.0, "azimuth_noise": 0.0, "doppler_noise": 0.0,
    "dropout": 0.0, "latency": 0.0, "period": 0.01, "mount": 0.0,
    "ghost_share": 0.0, "baseline": 0.0, "least_pixels": 0.0,
    "elevation_beam": 0.0, "elevation_noise": 0.0, "least_clearance": 0.0, "least_height": 0.0,
    "scale_bias": 0.0, "scale_drift": 0.0, "azimuth_bias": 0.0, "azimuth_drift": 0.0, "dropout_time": 0.0,
}  # fmt: skip
CAR: dict[str, Any] = {"class": "car", "length": 4.0, "width": 2.0, "height": 1.5}
WALKER: dict[str, Any] = {"class": "pedestrian", "length": 0.4, "width": 0.6, "height": 1.8}
TRUCK: dict[str, Any] = {"class": "truck", "length": 12.0, "width": 2.5, "height": 4.0}


def clean(new_part: NewPart, name: str, **parameters: Any) -> Any:
    part = new_part(name)
    for key, value in (CLEAN | parameters).items():
        if key in part.slots:
            part[key] = value
    return part


def place(part: Any, number: int, x: float, y: float = 0.0, heading: float = 0.0, **values: Any) -> None:
    for name, value in {**CAR, "id": number, "x": x, "y": y, "heading": heading, **values}.items():
        part[f"actors[{number}].{name}"] = value


def seen(part: Any) -> list[dict[str, float]]:
    part.step()
    return told(part)


def told(part: Any) -> list[dict[str, float]]:
    keys = ("range", "azimuth", "range_rate", "strength", "class", "width", *DEVIATIONS)
    returns = [f"scan.returns[{number}]" for number in range(1, 17)]
    return [{key: part[f"{one}.{key}"] for key in keys} for one in returns if part[f"{one}.valid"]]


def corners(x: float, y: float, heading: float, length: float, width: float) -> list[Point]:
    c, s = math.cos(heading), math.sin(heading)
    ends = [(-length, -width), (length, -width), (length, width), (-length, width)]
    return [(x + (a * c - b * s) / 2, y + (a * s + b * c) / 2) for a, b in ends]


def fan(boxes: list[list[Point]], azimuths: NDArray[np.float64]) -> tuple[Any, Any, Any]:
    """Of each ray from the origin: the distance it goes, the box and the side of it that it meets (-1: none)."""
    dx, dy = np.cos(azimuths), np.sin(azimuths)
    best, which, side = np.full(len(dx), np.inf), np.full(len(dx), -1), np.full(len(dx), -1)
    for number, box in enumerate(boxes):
        for k, ((ax, ay), (bx, by)) in enumerate(zip(box, box[1:] + box[:1], strict=True)):
            ex, ey = bx - ax, by - ay
            with np.errstate(divide="ignore", invalid="ignore"):
                far, share = (ax * ey - ay * ex) / (dx * ey - dy * ex), (ax * dy - ay * dx) / (dx * ey - dy * ex)
            met = (far > 0) & (share >= 0) & (share <= 1) & (far < best)
            best[met], which[met], side[met] = far[met], number, k
    return best, which, side


RAIN = 1 / 3.6e6  # 1 mm/h


def test_patches_of_spray_begin_at_the_truck_by_their_chance_and_are_left_behind(new_part: NewPart) -> None:
    part = clean(new_part, "object_lidar", beam_spacing=0.0, layer_spacing=0.0, range_cell=0.0, spray_depth=0.0)
    place(part, 1, 56.0, **TRUCK, speed=80 / 3.6)  # its rear face is 50 m ahead
    part["visibility.rain_rate"] = RAIN
    part.init()
    scans, places = 40_000, []
    for _ in range(scans):
        found = seen(part)
        (truck,) = [row["range"] for row in found if row["width"] > 0]
        patches = [row["range"] for row in found if row["width"] == 0]
        assert (truck, len(patches) <= 1) == (50.0, True)
        places.append(50.0 - patches[0] if patches else math.nan)
    behind = np.array(places)
    # From scan to scan it drifts by half of the truck's speed, within 10 m.
    steps = np.diff(behind)
    assert steps[np.isfinite(steps)] == pytest.approx(0.5 * 80 / 3.6 * 0.01, abs=1e-9)
    assert 9.8 < np.nanmax(behind) <= 10.0
    # 10 % at 100 km/h, with the square of the speed; five standard deviations of a binomial number.
    free = np.isnan(behind[:-1])
    begun = free & np.isfinite(behind[1:])
    assert behind[1:][begun] == pytest.approx(0.0, abs=1e-12)
    chance = 0.1 * (80 / 100) ** 2
    assert begun.sum() / free.sum() == pytest.approx(chance, abs=5 * math.sqrt(chance * (1 - chance) / free.sum()))


@pytest.mark.parametrize("name", ["object_lidar", "object_camera", "object_stereo", "object_radar_mid"])
def test_a_truck_is_seen_through_its_spray_only_by_what_light_is_left(new_part: NewPart, name: str) -> None:
    part = clean(new_part, name, beam_spacing=0.0, layer_spacing=0.0, spray_share=0.0)
    place(part, 1, 46.0, **TRUCK, speed=100 / 3.6)
    part.init()
    strengths = []
    for rain in (1e-30, RAIN * 1e-20):
        part["visibility.rain_rate"] = 0.0
        (dry,) = seen(part)
        part["visibility.rain_rate"] = rain
        (wet,) = seen(part)
        strengths.append(wet["strength"] / dry["strength"])
    assert strengths == pytest.approx([math.exp(-2 * 0.7) if "radar" not in name else 1.0] * 2, rel=1e-9)


@pytest.mark.parametrize(
    "values",
    [{"rain": 0.0}, {**CAR}, {"heading": math.pi}, {"speed": 0.0}, {"class": "motorcycle"}],
    ids=["no rain", "a car", "an oncoming truck", "a parked truck", "a motorcycle"],
)
def test_nothing_else_makes_spray(new_part: NewPart, values: dict[str, Any]) -> None:
    part = clean(new_part, "object_lidar", beam_spacing=0.0, layer_spacing=0.0, spray_share=1.0)
    part["visibility.rain_rate"] = values.pop("rain", RAIN)
    place(part, 1, 46.0, **({**TRUCK, "speed": 25.0} | values))
    part.init()
    assert all(len(seen(part)) == 1 for _ in range(100))


@pytest.mark.parametrize("name", SENSORS)
def test_range_azimuth_and_width_are_those_of_the_rear_face_ahead(new_part: NewPart, name: str) -> None:
    part = clean(new_part, name, mount=2.5, beam_spacing=0.0)
    part["motion.x"], part["motion.y"], part["motion.heading"] = 100.0, -20.0, 0.7
    ahead, aside = 45.0, 4.0
    c, s = math.cos(0.7), math.sin(0.7)
    place(part, 3, 100 + ahead * c - aside * s, -20 + ahead * s + aside * c, heading=0.7)
    part.init()
    (found,) = told(part)
    x = ahead - 2.0 - 2.5
    assert found["range"] == pytest.approx(math.hypot(x, aside), rel=1e-12)
    assert found["azimuth"] == pytest.approx(math.atan2(aside, x), rel=1e-12)
    span = math.atan2(aside + 1, x) - math.atan2(aside - 1, x)
    width = 2 * math.hypot(x, aside) * math.tan(span / 2) if "tells_width" in part.slots else 0.0
    assert found["width"] == pytest.approx(width, rel=1e-12)
    assert found["class"] == (1 if "tells_class" in part.slots else 0)


def test_what_is_seen_of_boxes_that_hide_each_other_equals_a_dense_fan_of_rays(new_part: NewPart) -> None:
    part = clean(new_part, "object_radar_long", range_cell=0.0, threshold=1e-9, min_visible=0.05)
    part["field_of_view"], spacing = 2.0, 1e-4
    azimuths = np.arange(-1 + spacing / 2, 1, spacing)
    hidden = []

    @settings(max_examples=30, deadline=None, derandomize=True)
    @given(
        st.lists(
            st.tuples(st.floats(-4, 4), st.floats(0.5, 12), st.floats(0.5, 3), st.floats(-9, 9)), min_size=2, max_size=8
        )
    )
    def check(shapes: Any) -> None:
        for number in range(1, 9):
            part[f"actors[{number}].class"] = "none"
        boxes = []
        for number, (turn, length, width, y) in enumerate(shapes):  # one row behind another: no two overlap
            x = 12.0 + 13 * number
            place(part, number + 1, x, y, turn, length=length, width=width)
            boxes.append(corners(x, y, turn, length, width))
        part.init()
        _, which, side = fan(boxes, azimuths)
        wanted = []
        for number, box in enumerate(boxes):
            mine = which == number
            alone = int(np.sum(fan([box], np.arange(-3, 3, spacing))[1] == 0))
            share = np.sum(mine) / alone
            counts = [int(np.sum(mine & (side == k))) for k in range(4)]
            second, first = sorted(counts)[-2:]
            if abs(share - 0.05) < 0.01 or (share >= 0.05 and first - second < 5):
                return  # on the edge of what a fan can tell
            hidden.append(share < 0.999)
            if share < 0.05:
                continue
            k = counts.index(first)
            rays = azimuths[mine & (side == k)]
            ends = []
            for azimuth in (rays[0] - spacing / 2, rays[-1] + spacing / 2):
                (ax, ay), (bx, by) = box[k], box[(k + 1) % 4]
                dx, dy = math.cos(azimuth), math.sin(azimuth)
                along = (ax * dy - ay * dx) / (dx * (by - ay) - dy * (bx - ax))
                along = min(max(along, 0.0), 1.0)
                ends.append((ax + along * (bx - ax), ay + along * (by - ay), abs(dx * (by - ay) - dy * (bx - ax))))
            x, y = (ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2
            grazing = min(ends[0][2], ends[1][2]) / math.dist(box[k], box[(k + 1) % 4])
            wanted.append((math.hypot(x, y), math.atan2(y, x), 110 * spacing / max(grazing, 1e-3)))
        found = told(part)
        assert len(found) == len(wanted)
        for one, (distance, azimuth, blur) in zip(found, sorted(wanted), strict=True):
            assert one["range"] == pytest.approx(distance, abs=2 * blur)
            assert one["azimuth"] == pytest.approx(azimuth, abs=2 * blur / distance)

    check()
    assert sum(hidden) > 20


def test_a_truck_hides_a_pedestrian_until_the_line_of_sight_past_its_corner(new_part: NewPart) -> None:
    part = clean(new_part, "object_radar_mid", min_visible=0.5)
    place(part, 1, 26.0, **TRUCK)  # rear at 20 m, front at 32 m; its rear left corner hides up to y = x * 1.25 / 20
    edge = 40.0 * 1.25 / 20
    part.init()
    # Seen of a face 0.6 m wide at 40 m: more than half of its angle once its middle is past the line.
    place(part, 2, 40.2, edge - 0.02, **WALKER)
    assert len(seen(part)) == 1
    place(part, 2, 40.2, edge + 0.03, **WALKER)
    found = seen(part)
    assert [round(one["range"], 1) for one in found] == [20.0, 40.1]
    assert found[1]["azimuth"] > math.atan2(1.25, 20)  # told is the middle of the part that shows


def test_what_hides_lessens_the_echo_by_the_share_it_hides(new_part: NewPart) -> None:
    part = clean(new_part, "object_radar_long")
    place(part, 1, 52.0)
    part.init()
    (whole,) = seen(part)
    place(part, 2, 20.0, -1.0, length=0.01, width=2.0)  # hides all to the right
    half = next(one for one in seen(part) if one["range"] > 40)
    assert half["strength"] == pytest.approx(whole["strength"] / 2 * (50 / math.hypot(50, 0.5)) ** 4, rel=1e-9)
    assert half["azimuth"] == pytest.approx(math.atan2(0.5, 50), rel=1e-9)


@pytest.mark.parametrize("name", ["object_radar_long", "object_lidar"])
@pytest.mark.parametrize("kind", ["car", "truck", "motorcycle", "bicycle", "pedestrian"])
def test_an_echo_is_detected_up_to_the_range_of_the_radar_equation(new_part: NewPart, name: str, kind: str) -> None:
    part = clean(new_part, name, beam_spacing=0.0, layer_spacing=0.0)
    reach = part["max_range"] * (part[kind] / part["car"]) ** (1 / part["echo_exponent"])
    kinds: dict[str, Any] = {"class": kind}
    part.init()
    place(part, 1, reach * (1 - 1e-9) + 2, **kinds)
    (found,) = seen(part)
    assert found["strength"] == pytest.approx(part["threshold"], rel=1e-6)
    place(part, 1, reach * (1 + 1e-9) + 2, **kinds)
    assert seen(part) == []


@pytest.mark.parametrize(
    ("name", "weather", "lost"),
    [
        ("object_radar_long", {"rain_rate": 50 / 3.6e6}, 1.132 * 50**0.718 * math.log(10) / 1e4),
        ("object_radar_long", {"fog_extinction": 0.06}, 0.0),
        ("object_lidar", {"rain_rate": 50 / 3.6e6}, 1.076 * 50**0.67 * math.log(10) / 1e4),
        ("object_lidar", {"fog_extinction": 0.06}, 0.06),
    ],
)
def test_weather_takes_from_an_echo_what_it_takes_on_both_ways(
    new_part: NewPart, name: str, weather: dict[str, float], lost: float
) -> None:
    part = clean(new_part, name, beam_spacing=0.0, layer_spacing=0.0, threshold=1e-3)
    place(part, 1, 22.0)
    part.init()
    (dry,) = seen(part)
    for key, value in weather.items():
        part[f"visibility.{key}"] = value
    (wet,) = seen(part)
    assert wet["strength"] / dry["strength"] == pytest.approx(math.exp(-2 * lost * 20), rel=1e-12)


def test_a_camera_sees_as_far_as_contrast_in_fog_and_lamps_by_night(new_part: NewPart) -> None:
    part = clean(new_part, "object_camera")
    part.init()
    for weather, reach in (({}, 120.0), ({"fog_extinction": 0.06}, -math.log(0.05) / 0.06), ({"darkness": 1.0}, 60.0)):
        part["visibility.fog_extinction"] = weather.get("fog_extinction", 0.0)
        part["visibility.darkness"] = weather.get("darkness", 0.0)
        place(part, 1, reach * (1 - 1e-9) + 2)
        assert len(seen(part)) == 1
        place(part, 1, reach * (1 + 1e-9) + 2)
        assert seen(part) == []


def test_doppler_is_the_rate_of_the_range_of_two_cars_that_move(new_part: NewPart) -> None:
    part = clean(new_part, "object_radar_mid", mount=2.5, range_cell=0.0)

    def look(t: float) -> dict[str, float]:
        """A car that drives 20 m/s and slips and turns, and one that crosses before it; both by their motions."""
        turn = 0.1 * t
        part["motion.x"] = 20 * t - 0.5 * turn * t  # to first order in t: slip to the left 0.5 m/s
        part["motion.y"], part["motion.heading"] = 0.5 * t, turn
        part["motion.speed"], part["motion.lateral_speed"], part["motion.yaw_rate"] = 20.0, 0.5, 0.1
        vx, vy = 9 * math.cos(1.2) + 0.3 * math.sin(1.2), 9 * math.sin(1.2) - 0.3 * math.cos(1.2)
        place(part, 1, 40 + vx * t, -6 + vy * t, 1.2, speed=9.0, lateral_speed=-0.3)
        (found,) = seen(part)
        return found

    part.init()
    now, h = look(0.0), 1e-5
    # The told point stays on the car: the middle of a face that is seen whole.
    assert now["range_rate"] == pytest.approx((look(h)["range"] - look(-h)["range"]) / (2 * h), abs=1e-4)
    assert now["range_rate"] < -5


@pytest.mark.parametrize(("apart", "count"), [("range", 2), ("azimuth", 2), ("doppler", 2), ("nothing", 1)])
def test_objects_are_told_apart_by_range_azimuth_or_doppler_and_else_merge(
    new_part: NewPart, apart: str, count: int
) -> None:
    part = clean(new_part, "object_radar_long", min_visible=0.0)
    x, y, v = 60.0, 0.0, 0.0
    x += 1.01 * part["range_cell"] if apart == "range" else 0.5 * part["range_cell"]
    y += x * math.tan(1.01 * part["azimuth_cell"]) if apart == "azimuth" else 0.0
    v += 1.01 * part["doppler_cell"] if apart == "doppler" else 0.0
    place(part, 1, 62.0)
    place(part, 2, x + 2.0, y, speed=v)
    part.init()
    found = told(part)
    assert len(found) == count
    if count == 1:
        weights = np.array([60.0**-4, x**-4])
        assert found[0]["range"] == pytest.approx(weights @ [60, x] / weights.sum(), rel=1e-12)
        assert found[0]["strength"] == pytest.approx(20 * 250**4 * weights.sum(), rel=1e-12)


def test_a_lidar_sees_what_a_beam_and_a_layer_meet_and_measures_width_by_its_beams(new_part: NewPart) -> None:
    part = clean(new_part, "object_lidar", max_range=400.0)
    part.init()
    place(part, 1, 52.0)
    (found,) = seen(part)
    spacing = math.radians(0.25)
    beams = 2 * math.floor(math.atan(1 / 50) / spacing)  # spacings between the outermost beams that meet it
    assert found["width"] == pytest.approx(2 * 50 * math.tan(beams * spacing / 2), rel=1e-12)
    place(part, 1, 152.0, 152 * math.tan(1.5 * spacing), width=0.3, length=0.3)  # between two beams
    assert seen(part) == []
    place(part, 1, 20.0, width=2.0, height=0.2)  # the lowest layer is 0.5 - 18 tan(1.2 deg) = 0.12 m above the road
    assert len(seen(part)) == 1
    place(part, 1, 13.0, width=2.0, height=0.2)  # and 0.27 m at 11 m
    assert seen(part) == []


@pytest.mark.parametrize("name", SENSORS)
def test_nobody_is_seen_beyond_the_field_of_view(new_part: NewPart, name: str) -> None:
    part = clean(new_part, name, beam_spacing=0.0, min_visible=0.9)
    assert float(part.component.properties["range"].si) == part["max_range"]
    assert float(part.component.properties["field_of_view"].si) == pytest.approx(part["field_of_view"])
    part.init()
    for turn, count in ((-0.03, 1), (0.03, 1 if part["field_of_view"] > 6 else 0)):
        azimuth = min(part["field_of_view"] / 2, 3.0) + turn
        place(part, 1, 30 * math.cos(azimuth), 30 * math.sin(azimuth), azimuth, length=0.1, width=0.2)
        assert len(seen(part)) == count


def test_the_perfect_sensor_sees_behind_a_truck_and_behind_the_car(new_part: NewPart) -> None:
    part = clean(new_part, "object_perfect")
    place(part, 1, 26.0, **TRUCK)
    place(part, 2, 40.0, **WALKER)
    place(part, 3, -30.0)
    part.init()
    assert [one["range"] for one in told(part)] == pytest.approx([20.0, 28.0, 39.8], rel=1e-12)
    assert [one["width"] for one in told(part)] == pytest.approx([2.5, 2.0, 0.6], rel=1e-12)


@pytest.mark.parametrize(("period", "latency"), [(1, 0), (4, 0), (2, 30), (6, 6), (8, 5), (4, 11)])
def test_a_scan_is_made_every_period_and_told_one_latency_later(new_part: NewPart, period: int, latency: int) -> None:
    part = clean(new_part, "object_radar_mid", period=period / 100, latency=latency / 100, mount=1.5)
    place(part, 1, 13.5)
    part.init()
    assert part["scan.number"] == (0 if latency else 1)
    for k in range(80):  # steps of 10 ms, the first at time 0
        place(part, 1, 13.5 + k)
        found = seen(part)
        number = (k - latency) // period + 1 if k >= latency else 0
        assert (part["scan.number"], part["scan.mount"]) == (number, 1.5)
        looked = (number - 1) * period
        assert [one["range"] for one in found] == pytest.approx([10.0 + looked] if number else [], rel=1e-14)
        assert part["scan.age"] == pytest.approx((k - looked) / 100 if number else 0.0, abs=1e-15)


def value(part: Any, name: str) -> float:
    return float(part[name]) if name in part.slots else 0.0


@pytest.mark.parametrize("name", SENSORS)
@pytest.mark.parametrize("ahead", [22.0, 62.0])
def test_a_sensor_tells_how_large_its_errors_are(new_part: NewPart, name: str, ahead: float) -> None:
    part = new_part(name)
    for key in ("dropout", "ghost_share"):
        if key in part.slots:
            part[key] = 0.0
    place(part, 1, ahead)
    part.init()
    for _ in range(31):
        part.step()
    (found,) = told(part)
    distance = found["range"]
    eyes = value(part, "baseline") * value(part, "focal_length")  # R = f b / d, so that dR = R^2 / (f b) dd
    stereo = value(part, "disparity_noise") * distance**2 / eyes if eyes else 0.0
    sigma = math.hypot(value(part, "range_noise"), value(part, "relative_noise") * distance, stereo)
    assert found["range_deviation"] == pytest.approx(sigma, rel=1e-12)
    assert found["azimuth_deviation"] == value(part, "azimuth_noise")
    assert found["rate_deviation"] == (max(value(part, "doppler_noise"), 1e-3) if value(part, "doppler") else 0)
    assert float(part.component.properties["latency"].si) == value(part, "latency")


def test_the_range_of_a_stereo_camera_gets_worse_with_its_square(new_part: NewPart) -> None:
    """By triangulation: noise of the disparity alone, turned into range, with 99.7 % confidence."""
    n, deviations = 4000, []
    for ahead in (20.0, 40.0):
        part = clean(new_part, "object_stereo", baseline=0.12, disparity_noise=0.2, seed=3)
        place(part, 1, ahead + 2)
        part.init()
        ranges = np.array([seen(part)[0]["range"] for _ in range(n)])
        disparity = part["focal_length"] * 0.12 / ahead
        sigma = ahead - part["focal_length"] * 0.12 / (disparity + 0.2)  # one deviation nearer, the whole way
        assert ranges.std(ddof=1) == pytest.approx(sigma, rel=0.03 + 3 / math.sqrt(2 * n))
        deviations.append(ranges.std(ddof=1))
    assert deviations[1] / deviations[0] == pytest.approx(4, rel=3 * math.sqrt(1 / n))


@pytest.mark.parametrize("rail", [7.0, -4.5])
def test_a_rail_shows_an_object_where_the_shortest_way_over_it_ends(new_part: NewPart, rail: float) -> None:
    """Range and Doppler of the image against Fermat's principle, at a car that yaws on a lane."""
    part = clean(
        new_part, "object_radar_mid", mount=2.0, range_cell=0.0, rail=rail, ghost_share=1.0, own_reflection=0.0
    )
    part["field_of_view"], lane = math.pi, 0.4  # of the lane in the plane

    def look(t: float) -> tuple[dict[str, float], float, float]:
        heading, offset = 0.55 + 0.1 * t, 0.6
        x, y = 18 * math.cos(0.55) * t, 18 * math.sin(0.55) * t
        part["motion.x"], part["motion.y"], part["motion.heading"] = x, y, heading
        part["motion.speed"], part["motion.yaw_rate"] = 18.0, 0.1
        moved = -math.sin(lane) * x + math.cos(lane) * y  # to the left of the lane
        part["lane.offset"], part["lane.heading"] = offset + moved, heading - lane
        vx, vy = 11 * math.cos(0.3), 11 * math.sin(0.3)
        place(part, 1, 32 + vx * t, 14.5 + vy * t, 0.3, speed=11.0, length=0.02, width=0.01)
        found = seen(part)
        assert len(found) == 2
        direct, image = found
        # The sensor and the told point, by what is told directly; then the way over each point of the rail.
        turn = heading + direct["azimuth"]
        sx, sy = x + 2 * math.cos(heading), y + 2 * math.sin(heading)
        px, py = sx + direct["range"] * math.cos(turn), sy + direct["range"] * math.sin(turn)
        along, aside = np.array([math.cos(lane), math.sin(lane)]), np.array([-math.sin(lane), math.cos(lane)])
        places = np.linspace(-20, 80, 400_001)
        points = np.outer(places, along) + (rail - offset) * aside
        ways = np.hypot(points[:, 0] - sx, points[:, 1] - sy) + np.hypot(points[:, 0] - px, points[:, 1] - py)
        best = points[np.argmin(ways)]
        return image, float(ways.min()), math.atan2(best[1] - sy, best[0] - sx) - heading

    part.init()
    image, way, azimuth = look(0.0)
    assert image["range"] == pytest.approx(way, abs=1e-7)
    assert image["azimuth"] == pytest.approx(azimuth, abs=1e-4)
    h = 1e-3
    assert image["range_rate"] == pytest.approx((look(h)[1] - look(-h)[1]) / (2 * h), abs=2e-3)
    strength = 20 * (160 / way) ** 4 * 0.5**2
    assert image["strength"] == pytest.approx(strength, rel=1e-6)
    place(part, 1, 32.0, 14.5 + 2 * rail, 0.3)
    part["lane.heading"] = part["lane.offset"] = part["motion.heading"] = 0.0
    place(part, 1, 32.0, 2.5 * rail)  # behind it
    assert len(seen(part)) == 1


def test_a_second_bounce_is_twice_as_far_and_as_fast_and_weaker_by_the_radar_equation(new_part: NewPart) -> None:
    part = clean(new_part, "object_radar_long", ghost_share=1.0, own_reflection=20.0)
    place(part, 1, 17.0, speed=-3.0)
    part.init()
    direct, ghost = seen(part)
    assert (ghost["range"], ghost["azimuth"]) == (2 * direct["range"], direct["azimuth"])
    assert ghost["range_rate"] == 2 * direct["range_rate"] == -6.0
    # Power density of a sphere, reflected by 20 m2 of the own car and by 100 m2 of the other one, each once more.
    again = 20 / (4 * math.pi * 15**2) * 100 / (4 * math.pi * 15**2)
    assert ghost["strength"] == pytest.approx(direct["strength"] * again, rel=1e-12)
    place(part, 1, 80.0)
    assert len(seen(part)) == 1  # too weak


def test_ghosts_show_in_their_share_of_the_scans_and_leave_the_noise_of_objects_as_it_is(new_part: NewPart) -> None:
    n, share = 4000, 0.3
    part = clean(new_part, "object_radar_long", ghost_share=share, own_reflection=20.0, rail=8.0, range_noise=0.1)
    other = clean(new_part, "object_radar_long", range_noise=0.1)
    counts = []
    for one in (part, other):
        place(one, 1, 17.0)
        one.init()
    part["field_of_view"] = 3.0
    for _ in range(n):
        found = seen(part)
        assert found[0] == seen(other)[0]
        counts.append(
            (any(abs(g["azimuth"]) < 0.1 for g in found[1:]), any(abs(g["azimuth"]) > 0.1 for g in found[1:]))
        )
    shown = np.array(counts)
    assert np.abs(shown.mean(axis=0) - share).max() < 3 * math.sqrt(share * (1 - share) / n)  # 99.7 %
    assert abs(np.corrcoef(shown.T)[0, 1]) < 3 / math.sqrt(n)


@pytest.mark.parametrize("layers", [1, 4, 8, 16])
@pytest.mark.parametrize("mount_height", [0.4, 1.9])
def test_a_layer_of_a_lidar_meets_what_stands_in_its_height_on_a_level_road(
    new_part: NewPart, layers: int, mount_height: float
) -> None:
    spacing = math.radians(30 / 15) if layers == 16 else math.radians(0.8)  # 16 over 30 deg, as a VLP-16 has them
    part = clean(new_part, "object_lidar", beam_spacing=0.0, threshold=1e-6, layer_spacing=spacing)
    part["layers"], part["mount_height"] = layers, mount_height
    part.init()
    met = []
    for height in (0.1, 0.3, 1.5, 4.0):
        for distance in np.arange(3.0, 100.0, 4.7):
            place(part, 1, distance + 2, height=height)
            tops = [mount_height + distance * math.tan(spacing * (k - (layers - 1) / 2)) for k in range(layers)]
            met.append(any(0 <= top <= height for top in tops))
            assert len(seen(part)) == met[-1]
    assert 0 < sum(met) < len(met)


def test_noise_and_dropouts_are_as_large_as_asked_for(new_part: NewPart) -> None:
    n, sigmas = 8000, {"range": 0.3, "azimuth": 0.01, "range_rate": 0.08}
    part = clean(
        new_part, "object_radar_mid", range_noise=0.3, azimuth_noise=0.01, doppler_noise=0.08, dropout=0.2, seed=5
    )
    place(part, 1, 52.0, speed=4.0)
    part.init()
    rows = [found[0] for found in (seen(part) for _ in range(n)) if found]
    # Each of these holds with 99.7 % (three standard errors).
    assert abs(len(rows) / n - 0.8) < 3 * math.sqrt(0.8 * 0.2 / n)
    columns = []
    for (key, sigma), true in zip(sigmas.items(), (50.0, 0.0, 4.0), strict=True):
        column = np.array([row[key] for row in rows]) - true
        assert abs(column.mean()) < 3 * sigma / math.sqrt(len(rows))
        assert abs(column.std(ddof=1) - sigma) < 3 * sigma / math.sqrt(2 * len(rows))
        assert abs(np.corrcoef(column[1:], column[:-1])[0, 1]) < 3 / math.sqrt(len(rows))
        columns.append(column)
    assert np.abs(np.corrcoef(columns) - np.eye(3)).max() < 3 / math.sqrt(len(rows))


def test_the_same_seed_gives_the_same_bits_and_nobodys_noise_depends_on_others(new_part: NewPart) -> None:
    def ranges(seed: int, *, crowd: bool) -> list[float]:
        part = new_part("object_camera", seed=seed, dropout=0.0, period=0.01, latency=0.0)
        place(part, 1, 30.0)
        part.init()
        if crowd:
            place(part, 2, 60.0, 12.0)
        return [min(one["range"] for one in seen(part)) for _ in range(20)]

    assert ranges(3, crowd=False) == ranges(3, crowd=True)
    assert not set(ranges(3, crowd=False)) & set(ranges(4, crowd=False))


LASTING = {"scale_bias": 0.03, "scale_drift": 0.02, "azimuth_bias": 0.01, "azimuth_drift": 0.005}
LONG = [2000, pytest.param(100_000, marks=pytest.mark.thorough)]


def record(part: Any, scans: int) -> NDArray[np.float64]:
    """Range and azimuth of the only object, scan by scan; NaN where it is lost."""
    valid, *told = (part.slots[f"scan.returns[1].{name}"][1] for name in ("valid", "range", "azimuth"))
    rows = np.full((scans, 2), np.nan)
    for row in rows:
        part.step()
        if valid.value:
            row[:] = [one.value for one in told]
    return rows


def uniform(seed: int, number: int) -> float:
    """Number *number* of SplitMix64, by its published code."""
    mask = 2**64 - 1
    z = (seed + (number + 1) * 0x9E3779B97F4A7C15) & mask
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
    return (((z ^ (z >> 31)) >> 11) + 1) * 2.0**-53


def test_without_lasting_errors_and_bursts_each_scan_has_the_bits_of_white_noise(new_part: NewPart) -> None:
    part = clean(new_part, "object_camera", seed=7, dropout=0.3, relative_noise=0.05, azimuth_noise=0.01)
    place(part, 1, 42.0, 5.0)
    part.init()
    found = record(part, 200)
    true = record(clean_at(new_part, 42.0, 5.0), 1)[0]
    for scan, row in enumerate(found):
        first, second, _, _, lost = (uniform(7, scan * 24 * 5 + k) for k in range(5))
        length, angle = math.sqrt(-2 * math.log(first)), 2 * math.pi * second
        deviation = math.sqrt((0.05 * true[0]) * (0.05 * true[0]))
        wanted = [true[0] + deviation * (length * math.cos(angle)), true[1] + 0.01 * (length * math.sin(angle))]
        assert list(row) == wanted if lost > 0.3 else np.isnan(row).all()


def clean_at(new_part: NewPart, x: float, y: float = 0.0, **parameters: Any) -> Any:
    part = clean(new_part, "object_camera", **parameters)
    place(part, 1, x, y)
    part.init()
    return part


def test_lasting_errors_leave_the_white_noise_and_the_losses_as_they_are(new_part: NewPart) -> None:
    noise = {"relative_noise": 0.01, "azimuth_noise": 0.002, "dropout": 0.2, "dropout_time": 0.05}
    white = record(clean_at(new_part, 42.0, **noise), 300)
    both, slow = (record(clean_at(new_part, 42.0, **LASTING, **more), 300) for more in (noise, {}))
    assert np.isnan(white).any()
    np.testing.assert_allclose(both, white + slow - [40.0, 0.0], rtol=0, atol=1e-12)


@pytest.mark.parametrize(("ahead", "key"), [(40.0, "scale_bias"), (80.0, "scale_bias"), (40.0, "azimuth_bias")])
def test_a_bias_is_constant_in_a_run_and_normal_over_runs(new_part: NewPart, ahead: float, key: str) -> None:
    runs, sigma, column = 3000, 0.02, int(key == "azimuth_bias")
    part, errors = clean(new_part, "object_camera", **{key: sigma}), []
    place(part, 1, ahead + 2)
    for seed in range(runs):
        part["seed"] = seed
        part.init()
        found = record(part, 2 if seed else 50)
        assert np.ptp(found, axis=0).max() == 0
        errors.append((found[0, column] - (0 if column else ahead)) / (1 if column else ahead))
    assert part["scan.misalignment.deviation" if column else "scan.scale.deviation"] == pytest.approx(sigma)
    assert abs(np.mean(errors)) < 3 * sigma / math.sqrt(runs)  # each with 99.7 %
    assert abs(np.std(errors, ddof=1) - sigma) < 3 * sigma / math.sqrt(2 * runs)
    assert abs(np.mean(np.abs(errors) < sigma) - 0.6827) < 3 * math.sqrt(0.6827 * 0.3173 / runs)


@pytest.mark.parametrize("scans", LONG)
@pytest.mark.parametrize("key", ["scale", "azimuth"])
def test_slow_and_white_errors_have_their_autocovariance(new_part: NewPart, scans: int, key: str) -> None:
    """Own estimates of slow variance, correlation time and white variance, from autocovariances at three lags.

    Their tolerances are three standard errors: Bartlett's covariance of the estimated autocovariances, through the
    derivatives of the three formulas.
    """
    slow, white, time = 0.03, 0.02, 10.0  # time in scans
    noise = {"scale_drift": slow, "relative_noise": white} if key == "scale" else {"azimuth_drift": slow}
    noise |= {} if key == "scale" else {"azimuth_noise": white}
    found = record(clean_at(new_part, 42.0, seed=11, correlation_time=time * 0.01, **noise), scans)
    errors = found[:, 0] / 40 - 1 if key == "scale" else found[:, 1]

    def covariance(lag: Any) -> Any:
        return slow**2 * np.exp(-np.abs(lag) / time) + white**2 * (np.abs(lag) == 0)

    lags = np.array([0, 1, 11])
    estimated = np.array([errors[: scans - lag] @ errors[lag:] / scans for lag in lags])
    m = np.arange(-400, 401)
    bartlett = np.array([[np.sum(covariance(m) * covariance(m + p - q) + covariance(m + q) * covariance(m - p))
                          for q in lags] for p in lags]) / scans  # fmt: skip

    def formulas(c: NDArray[np.float64]) -> NDArray[np.float64]:
        fade = (c[2] / c[1]) ** 0.1
        return np.array([c[1] / fade, -1 / math.log(fade), c[0] - c[1] / fade])

    true = formulas(covariance(lags))
    np.testing.assert_allclose(true, [slow**2, time, white**2], rtol=1e-9)
    steps = np.diag(1e-6 * covariance(lags))
    slopes = np.array([(formulas(covariance(lags) + s) - true) / s.sum() for s in steps]).T
    limits = 3 * np.sqrt(np.diag(slopes @ bartlett @ slopes.T))
    assert (np.abs(formulas(estimated) - true) < limits).all()
    assert scans < 100_000 or (limits < [0.1 * slow**2, 0.15 * time, 0.1 * white**2]).all()


@pytest.mark.parametrize("scans", LONG)
def test_losses_come_in_bursts_of_their_mean_length_with_the_same_share(new_part: NewPart, scans: int) -> None:
    share, length = 0.1, 6.0
    found = record(clean_at(new_part, 42.0, seed=3, dropout=share, dropout_time=length * 0.01), scans)
    lost = np.isnan(found[:, 0])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], lost.astype(int), [0]])))
    bursts = np.diff(edges)[::2]
    stays = 1 - 1 / length - share / (length * (1 - share))  # correlation of two scans
    error = math.sqrt(share * (1 - share) / scans * (1 + stays) / (1 - stays))
    assert abs(lost.mean() - share) < 3 * error
    assert abs(bursts.mean() - length) < 3 * length * math.sqrt((1 - 1 / length) / len(bursts))  # geometric
    assert abs(np.mean(bursts == 1) - 1 / length) < 3 * math.sqrt(1 / length * (1 - 1 / length) / len(bursts))


def test_an_object_is_lost_in_the_same_scans_whatever_else_is_seen(new_part: NewPart) -> None:
    parts = [clean_at(new_part, 42.0, dropout=0.2, dropout_time=0.05) for _ in range(2)]
    place(parts[1], 2, 60.0, 12.0)
    patterns = [[any(abs(one["azimuth"]) < 0.1 for one in seen(part)) for _ in range(400)] for part in parts]
    assert patterns[0] == patterns[1]
    others = [any(one["azimuth"] > 0.1 for one in seen(parts[1])) for _ in range(400)]
    assert 0 < sum(others) < 400
    assert others != patterns[1]


@pytest.mark.parametrize(
    ("body", "smaller"), [(WALKER, 0.6), (CAR, 1.5), ({**CAR, "height": 0.4}, 0.4), ({**WALKER, "width": 3.0}, 1.8)]
)
def test_a_camera_sees_what_has_enough_pixels(new_part: NewPart, body: dict[str, Any], smaller: float) -> None:
    part = clean(new_part, "object_camera", least_pixels=12.0, contrast=0.001)
    part["max_range"] = 400.0
    part.init()
    reach = 1372 * smaller / 12  # by similar triangles
    for share, count in ((1 - 1e-4, 1), (1 + 1e-4, 0)):
        place(part, 1, reach * share + body["length"] / 2, **body)
        assert len(seen(part)) == count


def test_a_pedestrian_is_lost_in_fog_before_a_car(new_part: NewPart) -> None:
    part = clean(new_part, "object_camera")
    part.init()
    part["visibility.fog_extinction"] = 0.1
    for body, contrast in ((CAR, 1.0), (WALKER, 0.5)):
        reach = math.log(contrast / 0.05) / 0.1
        for share, count in ((1 - 1e-9, 1), (1 + 1e-9, 0)):
            place(part, 1, reach * share + body["length"] / 2, **body)
            assert len(seen(part)) == count


BRIDGE: dict[str, Any] = {"class": "obstacle", "length": 10.0, "width": 20.0, "height": 6.0, "clearance": 4.5}
COVER: dict[str, Any] = {"class": "obstacle", "length": 0.8, "width": 0.8, "height": 0.02}


@pytest.mark.parametrize("name", ["object_radar_mid", "object_lidar", "object_camera"])
@pytest.mark.parametrize(("clutter", "hides"), [(BRIDGE, False), (BRIDGE | {"clearance": 0.0}, True), (COVER, False)])
def test_what_is_above_or_below_the_sensor_hides_nothing(
    new_part: NewPart, name: str, clutter: dict[str, Any], hides: bool
) -> None:
    part = clean(new_part, name, beam_spacing=0.0, layer_spacing=0.0, contrast=0.001, threshold=1e-6)
    place(part, 1, 30.0, **clutter)
    place(part, 2, 60.0)
    part.init()
    face = 30 - clutter["length"] / 2
    assert [one["range"] for one in seen(part)] == pytest.approx([face] if hides else [face, 58])


@pytest.mark.parametrize("clutter", [BRIDGE, COVER])
def test_a_radar_loses_what_leaves_its_lobe_as_it_comes_near(new_part: NewPart, clutter: dict[str, Any]) -> None:
    """The gain of a Gaussian lobe is a half at half its beam beside the axis; the radar sees along it twice."""
    beam, found = math.radians(10), []
    part = clean(new_part, "object_radar_mid", elevation_beam=beam, mount_height=1.0, own_reflection=0.0)
    part.init()
    for ahead in (5.0, 12.0, 40.0, 90.0):
        place(part, 1, ahead + clutter["length"] / 2, **clutter)
        edge = clutter.get("clearance", clutter["height"])
        gain = 0.5 ** ((math.atan(abs(edge - 1.0) / ahead) / (beam / 2)) ** 2)
        strength = 20 * 10 / 100 * (160 / ahead) ** 4 * gain**2
        found.append(len(seen(part)))
        assert found[-1] == (strength >= 20)
        assert not found[-1] or told(part)[0]["strength"] == pytest.approx(strength, rel=1e-9)
    assert found[0] == 0 or clutter is COVER
    assert 1 in found


def test_a_measured_height_lets_bridges_and_covers_be_rejected_as_often_as_its_error_allows(new_part: NewPart) -> None:
    n, sigma, limit = 3000, math.radians(0.5), {"least_clearance": 3.0, "least_height": 0.2}
    for clutter, ahead, inside in ((BRIDGE, 100.0, 3.0 - 4.5), (COVER, 30.0, 0.02 - 0.2), (CAR, 50.0, 1.5 - 0.2)):
        part = clean(new_part, "object_camera", elevation_noise=sigma, contrast=0.001, **limit)
        place(part, 1, ahead + clutter["length"] / 2, **clutter)
        part.init()
        share = 0.5 * math.erfc(-inside / (ahead * sigma) / math.sqrt(2))
        seen_in = np.isfinite(record(part, n)[:, 0]).mean()
        assert abs(seen_in - share) <= 3 * math.sqrt(share * (1 - share) / n)  # 99.7 %
        part["least_clearance"] = part["least_height"] = 0.0
        assert np.isfinite(record(part, 100)).all()


def test_bias_slow_and_white_errors_are_independent_of_each_other(new_part: NewPart) -> None:
    runs, columns = 1000, []
    for noise in ({"scale_bias": 0.01}, {"scale_drift": 0.01}, {"relative_noise": 0.01}, {"azimuth_bias": 0.01}):
        part = clean_at(new_part, 42.0, **noise)
        errors = []
        for seed in range(runs):
            part["seed"] = seed
            part.init()
            errors.append(record(part, 1)[0, int("azimuth_bias" in noise)])
        columns.append(errors)
    assert np.abs(np.corrcoef(columns) - np.eye(4)).max() < 4 / math.sqrt(runs)  # six pairs, 99.96 %


POSES = [(2.0, 0.9, 0.8), (-2.2, -0.8, -2.6), (-2.3, 0.0, math.pi)]


@pytest.mark.parametrize("pose", POSES)
def test_range_and_azimuth_are_those_in_the_axes_of_the_mounted_sensor(
    new_part: NewPart, pose: tuple[float, float, float]
) -> None:
    """A post of 2 mm, placed by its range and azimuth in the world: R(heading + turn) (r cos a, r sin a)."""
    ahead, left, turn = pose
    part = clean(new_part, "object_corner_radar", mount=ahead, mount_left=left, mount_turn=turn, range_cell=0.0)
    part["motion.x"], part["motion.y"], part["motion.heading"] = 100.0, -20.0, 0.7
    sx = 100 + ahead * math.cos(0.7) - left * math.sin(0.7)
    sy = -20 + ahead * math.sin(0.7) + left * math.cos(0.7)
    part.init()
    for azimuth in (-1.0, -0.3, 0.0, 0.6, 1.04):
        away = 0.7 + turn + azimuth
        place(part, 1, sx + 30 * math.cos(away), sy + 30 * math.sin(away), away, length=2e-3, width=2e-3)
        (found,) = seen(part)
        assert (found["range"], found["azimuth"]) == pytest.approx((30 - 1e-3, azimuth), abs=1e-4)
        assert [part[f"scan.{name}"] for name in ("mount", "mount_left", "mount_turn")] == list(pose)
    place(
        part,
        1,
        sx + 30 * math.cos(0.7 + turn + 1.06),
        sy + 30 * math.sin(0.7 + turn + 1.06),
        0.7,
        length=2e-3,
        width=2e-3,
    )
    assert seen(part) == []  # beyond 60 deg


@pytest.mark.parametrize("name", ["object_corner_radar", "object_camera"])
@pytest.mark.parametrize("pose", POSES)
def test_a_mounted_sensor_sees_what_a_car_at_its_place_would_see_ahead(
    new_part: NewPart, name: str, pose: tuple[float, float, float]
) -> None:
    """Boxes that hide each other, Doppler of a car that yaws, the guard rail and the sun."""
    ahead, left, turn = pose
    ghosts = {"rail": 5.0, "ghost_share": 1.0, "own_reflection": 0.0} if name == "object_corner_radar" else {}
    mounted = clean(new_part, name, mount=ahead, mount_left=left, mount_turn=turn, range_cell=0.0, **ghosts)
    alone = clean(new_part, name, mount_left=0.0, mount_turn=0.0, range_cell=0.0, **ghosts)
    heading, speed, aside, yaw_rate, lane, offset = 0.4, 20.0, 0.5, 0.3, 0.1, 0.6
    c, s = math.cos(heading), math.sin(heading)
    along, across = speed - yaw_rate * left, aside + yaw_rate * ahead  # of the mount, along the car's axes
    there = {
        "motion.x": 5 + ahead * c - left * s,
        "motion.y": 7 + ahead * s + left * c,
        "motion.heading": heading + turn,
        "motion.speed": along * math.cos(turn) + across * math.sin(turn),
        "motion.lateral_speed": across * math.cos(turn) - along * math.sin(turn),
        "lane.heading": lane + turn,
        "lane.offset": offset + ahead * math.sin(lane) + left * math.cos(lane),
    }
    here = {
        "motion.x": 5.0, "motion.y": 7.0, "motion.heading": heading, "motion.speed": speed,
        "motion.lateral_speed": aside, "motion.yaw_rate": yaw_rate, "lane.heading": lane, "lane.offset": offset,
    }  # fmt: skip
    for part, motion in ((mounted, here), (alone, there)):
        for key, value in {**motion, "sun.azimuth": 0.3, "sun.elevation": 0.2, "sun.glare": 5.0}.items():
            part[key] = value
        for number, (far, azimuth) in enumerate(((15.0, -0.3), (22.0, 0.0), (30.0, 0.05)), 1):
            away = heading + turn + azimuth
            at = there["motion.x"] + far * math.cos(away), there["motion.y"] + far * math.sin(away)
            place(part, number, *at, 0.9 * number, speed=9.0, lateral_speed=-0.4)
        part.init()
    ours, theirs = seen(mounted), seen(alone)
    assert len(ours) == len(theirs) >= 2
    for one, other in zip(ours, theirs, strict=True):
        assert one == pytest.approx(other, rel=1e-9, abs=1e-9)
