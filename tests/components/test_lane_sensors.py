"""Lane sensors against lanes of which all is known: a clothoid, by numbers, and statistics of their errors."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

NewPart = Callable[..., Any]
Array = NDArray[np.float64]
SENSORS = ["lane_camera", "lane_map", "lane_perfect"]
EXACT: dict[str, Any] = {
    "offset_noise": 0.0, "heading_noise": 0.0, "curvature_noise": 0.0, "dropout": 0.0,
    "along_error": 0.0, "across_error": 0.0, "turn_error": 0.0, "latency": 0.0, "period": 0.01,
}  # fmt: skip
LANE = ("station", "offset", "heading", "curvature", "width", "grade", "bank", "speed_limit", "on_road")
POINT = ("distance", "x", "y", "heading", "curvature")
BENT = (0.004, 0.00005)  # curvature at station 0, and its growth per m


def clothoid(stations: Array, k0: float = BENT[0], k1: float = BENT[1]) -> tuple[Array, Array, Array]:
    """x, y and heading of the middle of a lane that begins at the origin along x; by quadrature, good to 1e-9 m."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    s = stations[:, None] * (nodes + 1) / 2
    turns = k0 * s + k1 * s * s / 2
    x, y = ((np.cos(turns) @ weights), (np.sin(turns) @ weights))
    return x * stations / 2, y * stations / 2, k0 * stations + k1 * stations**2 / 2


def exact(new_part: NewPart, name: str, **parameters: Any) -> Any:
    part = new_part(name)
    for key, value in (EXACT | parameters).items():
        if key in part.slots:
            part[key] = value
    return part


def stand(part: Any, station: float, offset: float, turn: float, spacing: float = 2.5) -> None:
    """Puts the car beside the clothoid: lane and preview as a road tells them."""
    ahead = spacing * np.arange(1, 25, dtype=np.float64)
    (x0,), (y0,), (h0,) = clothoid(np.array([station]))
    x, y, headings = clothoid(station + ahead)
    car = (x0 - offset * math.sin(h0), y0 + offset * math.cos(h0), h0 + turn)
    c, s = math.cos(car[2]), math.sin(car[2])
    lane = {
        "station": 100 + station, "offset": offset, "heading": turn, "curvature": BENT[0] + BENT[1] * station,
        "width": 3.5, "grade": 0.03, "bank": 0.02, "speed_limit": 27.0, "on_road": True,
    }  # fmt: skip
    for key, value in lane.items():
        part[f"lane.{key}"] = value
    for number in range(24):
        dx, dy = x[number] - car[0], y[number] - car[1]
        curvature = BENT[0] + BENT[1] * (station + ahead[number])
        point = (ahead[number], c * dx + s * dy, c * dy - s * dx, headings[number] - car[2], curvature)
        for key, value in zip(POINT, point, strict=True):
            part[f"preview[{number + 1}].{key}"] = value


def lane(part: Any, end: str = "seen.lane") -> dict[str, float]:
    return {key: part[f"{end}.{key}"] for key in LANE}


def points(part: Any, end: str = "seen.preview") -> Array:
    found = np.array([[part[f"{end}[{number}].{key}"] for key in POINT] for number in range(1, 25)])
    return found[found[:, 0] > 0]


@pytest.mark.parametrize("name", SENSORS)
def test_without_errors_the_lane_is_seen_as_it_is(new_part: NewPart, name: str) -> None:
    part = exact(new_part, name, max_range=0.0)
    stand(part, 12.0, 0.4, -0.05)
    part.init()
    part.step()
    assert part["seen.valid"]
    told, true = lane(part), lane(part, "lane")
    if name == "lane_camera":  # knows no station, and does not feel how the road lies
        true |= {"station": 0.0, "grade": 0.0, "bank": 0.0}
    assert told == true
    assert (points(part) == points(part, "preview")).all()
    assert {"cost", "mass", "power", "range", "field_of_view", "latency"} <= set(part.component.properties)


@pytest.mark.parametrize(
    ("weather", "reach"),
    [
        ({}, 60.0),
        ({"fog_extinction": 0.06}, -math.log(0.05) / 0.06),
        ({"rain_rate": 50 / 3.6e6}, min(60.0, -math.log(0.05) / (1.076 * 50**0.67 * math.log(10) / 1e4))),
        ({"snow_rate": 10 / 3.6e6}, -math.log(0.05) / (3.84 * 10**0.72 * math.log(10) / 1e4)),
        ({"darkness": 1.0}, 40.0),
        ({"darkness": 0.5}, 50.0),
    ],
)
def test_a_camera_sees_the_lane_as_far_as_contrast_and_lamps_do(
    new_part: NewPart, weather: dict[str, float], reach: float
) -> None:
    part = exact(new_part, "lane_camera")
    other = exact(new_part, "lane_map")
    for one in (part, other):
        stand(one, 0.0, 0.0, 0.0)
        for key, value in weather.items():
            one[f"visibility.{key}"] = value
        one.init()
        one.step()
    ahead = 2.5 * np.arange(1, 25)
    assert points(part)[:, 0] == pytest.approx(ahead[ahead <= reach])
    assert points(other)[:, 0] == pytest.approx(ahead)


@pytest.mark.parametrize(("period", "latency"), [(1, 0), (4, 8), (5, 3), (2, 30)])
@pytest.mark.parametrize("name", ["lane_camera", "lane_map"])
def test_a_lane_is_told_one_latency_after_it_was_seen(new_part: NewPart, name: str, period: int, latency: int) -> None:
    part = exact(new_part, name, period=period / 100, latency=latency / 100)
    part.init()
    for k in range(60):
        stand(part, 0.0, 0.01 * k, 0.0)
        part.step()
        assert part["seen.valid"] == (k >= latency)
        assert lane(part)["offset"] == (0.01 * ((k - latency) // period * period) if k >= latency else 0.0)


def test_errors_of_a_camera_are_as_large_as_asked_for_and_bend_the_whole_lane(new_part: NewPart) -> None:
    sigmas, n = {"offset": 0.05, "heading": 0.004, "curvature": 1e-4}, 3000
    part = exact(new_part, "lane_camera", **{f"{key}_noise": value for key, value in sigmas.items()}, seed=7)
    stand(part, 0.0, 0.3, 0.02)
    part.init()
    true, there, rows = lane(part, "lane"), points(part, "preview"), []
    for k in range(n):
        part.step()
        rows.append([part[f"seen.lane.{key}"] - true[key] for key in sigmas])
        if k > 30:
            continue
        offset, heading, curvature = rows[-1]
        told, s = points(part), there[:, 0]
        aside = (told[:, 1] - there[:, 1]) * math.sin(0.02) + (told[:, 2] - there[:, 2]) * math.cos(0.02)
        assert aside == pytest.approx(-offset - heading * s + curvature * s**2 / 2, abs=1e-9)
        assert told[:, 3] - there[:, 3] == pytest.approx(curvature * s - heading, abs=1e-9)
    columns = np.array(rows).T
    for column, sigma in zip(columns, sigmas.values(), strict=True):  # each with 99.7 %
        assert abs(column.mean()) < 3 * sigma / math.sqrt(n)
        assert abs(column.std(ddof=1) - sigma) < 3 * sigma / math.sqrt(2 * n)
        assert abs(np.corrcoef(column[1:], column[:-1])[0, 1]) < 3 / math.sqrt(n)
    assert np.abs(np.corrcoef(columns) - np.eye(3)).max() < 3 / math.sqrt(n)


def test_a_lane_out_of_sight_is_carried_on_by_how_the_car_moves(new_part: NewPart) -> None:
    """Fog for a second, while the car swerves: what is told stays within 2 cm of the lane, and is not valid."""
    part = exact(new_part, "lane_camera")
    x, y, heading = 0.0, 0.3, 0.01
    stand(part, 0.0, 0.3, 0.01)
    part.init()
    h, grid = 0.01, np.linspace(0, 30, 3001)
    gx, gy, gh = clothoid(grid)
    for k in range(101):
        speed, aside, rate = 20 - 2 * h * k, 0.2 * math.sin(0.06 * k), 0.1 + 0.1 * math.cos(0.05 * k)
        part["motion.speed"], part["motion.lateral_speed"], part["motion.yaw_rate"] = speed, aside, rate
        part["visibility.fog_extinction"] = 0.0 if k == 0 else 1.0
        part.step()
        assert part["seen.valid"] == (k == 0)
        if k == 100:
            break
        for part_of_step in range(50):  # to where it is a step later, in small steps of its own
            t = h * (k + (part_of_step + 0.5) / 50)
            v = (20 - 2 * t, 0.2 * math.sin(6 * t), 0.1 + 0.1 * math.cos(5 * t))
            middle = heading + v[2] * h / 100
            x += (v[0] * math.cos(middle) - v[1] * math.sin(middle)) * h / 50
            y += (v[0] * math.sin(middle) + v[1] * math.cos(middle)) * h / 50
            heading += v[2] * h / 50
    nearest = int(np.argmin((gx - x) ** 2 + (gy - y) ** 2))
    station = grid[nearest]
    offset = -math.sin(gh[nearest]) * (x - gx[nearest]) + math.cos(gh[nearest]) * (y - gy[nearest])
    told = lane(part)
    assert 18.5 < station < 19.5
    assert told["offset"] == pytest.approx(offset, abs=0.02)
    assert told["heading"] == pytest.approx(heading - gh[nearest], abs=2e-3)
    assert told["curvature"] == pytest.approx(BENT[0] + BENT[1] * station, abs=1e-6)
    for distance, px, py, turn, curvature in points(part):
        (tx,), (ty,), (th,) = clothoid(np.array([station + distance]))
        c, s = math.cos(heading), math.sin(heading)
        assert (x + c * px - s * py, y + s * px + c * py) == pytest.approx((tx, ty), abs=0.02)
        assert (heading + turn, curvature) == pytest.approx((th, BENT[0] + BENT[1] * (station + distance)), abs=1e-3)
    assert 10 < len(points(part)) < 24  # what lies behind is gone


def test_a_map_shows_the_lane_from_where_the_car_believes_to_be(new_part: NewPart) -> None:
    places = []
    for seed in range(12):
        part = exact(new_part, "lane_map", along_error=4.0, seed=seed)
        stand(part, 20.0, 0.4, -0.03)
        part.init()
        part.step()
        along = part["seen.lane.station"] - 120.0
        # Every point that is told lies on the lane as it is there; behind the car the curvature goes on as it is.
        told, blur = points(part), (2.5e-5 + abs(BENT[1] * along)) * abs(along) * 60 if along < 0 else 1e-4
        (bx,), (by,), (bh,) = clothoid(np.array([20.0 + along]))
        car = bh - 0.03
        for distance, px, py, turn, curvature in told:
            (tx,), (ty,), (th,) = clothoid(np.array([20.0 + along + distance]))
            dx, dy = tx - bx + 0.4 * math.sin(bh), ty - by - 0.4 * math.cos(bh)
            c, s = math.cos(car), math.sin(car)
            assert (px, py) == pytest.approx((c * dx + s * dy, c * dy - s * dx), abs=blur)
            assert (turn, curvature) == pytest.approx((th - car, BENT[0] + BENT[1] * (20 + along + distance)), abs=blur)
        places.append(along)
    assert min(places) < -3
    assert max(places) > 3


def test_errors_of_a_place_drift_as_a_gauss_markov_process_does(new_part: NewPart) -> None:
    tau, n = 0.5, 40_000
    part = exact(
        new_part, "lane_map", along_error=0.0, across_error=0.2, turn_error=0.01, correlation_time=tau, period=0.05
    )
    stand(part, 0.0, 0.0, 0.0, spacing=0.0)
    part.init()
    rows = []
    for _ in range(n):
        part.step()
        rows.append((lane(part)["offset"], lane(part)["heading"]))
    errors, fade = np.array(rows)[::5], math.exp(-0.05 / tau)
    spread = math.sqrt((1 + fade**2) / (1 - fade**2))  # of a mean of squares, against independent ones
    for column, sigma in zip(errors.T, (0.2, 0.01), strict=True):  # each with 99.7 %
        assert abs(np.mean(column**2) / sigma**2 - 1) < 3 * spread * math.sqrt(2 / len(column))
        following = np.corrcoef(column[1:], column[:-1])[0, 1]
        assert abs(following - fade) < 3 * math.sqrt((1 - fade**2) / len(column))
    assert abs(np.corrcoef(errors.T)[0, 1]) < 3 * spread / math.sqrt(len(errors))


def test_a_camera_misses_its_share_of_the_scans_and_the_same_seed_gives_the_same_bits(new_part: NewPart) -> None:
    n, share = 4000, 0.1

    def drive(seed: int) -> list[tuple[float, bool]]:
        part = new_part("lane_camera", seed=seed, dropout=share, period=0.01, latency=0.0)
        stand(part, 0.0, 0.2, 0.0)
        part.init()
        rows = []
        for _ in range(n):
            part.step()
            rows.append((part["seen.lane.offset"], bool(part["seen.valid"])))
        return rows

    first = drive(3)
    assert first == drive(3) != drive(4)
    missed = 1 - sum(valid for _, valid in first) / n
    assert abs(missed - share) < 3 * math.sqrt(share * (1 - share) / n)  # 99.7 %
