"""Trackers: the filter against a textbook one in numpy, which detection goes to which track, and who is told of."""

# ruff: noqa: N803, N806 - matrices have the names that textbooks give them

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

NewPart = Callable[..., Any]
Array = NDArray[np.float64]
T = 0.02
FAST = {"first_period": T, "second_period": T}
QUIET = {"first_mount": 0.0, "first_doppler_noise": 0.0, "acceleration_noise": 1.0}


def drive(part: Any, speed: float = 0.0, aside: float = 0.0, yaw_rate: float = 0.0) -> None:
    part["motion.speed"], part["motion.lateral_speed"], part["motion.yaw_rate"] = speed, aside, yaw_rate


def see(part: Any, sensor: str, *places: tuple[float, float], **values: Any) -> None:
    """Detections at places ahead and to the left of the sensor."""
    for number in range(1, 17):
        part[f"{sensor}[{number}].valid"] = number <= len(places)
    for number, (x, y) in enumerate(places, 1):
        told = {"range": math.hypot(x, y), "azimuth": math.atan2(y, x), "range_rate": 0.0, **values}
        for key, value in told.items():
            part[f"{sensor}[{number}].{key}"] = value


def tracks(part: Any) -> list[dict[str, Any]]:
    keys = ("id", "class", "x", "y", "vx", "vy", "width", "age")
    found = [{key: part[f"tracks[{i}].{key}"] for key in keys} for i in range(1, 9)]
    return [track for track in found if track["id"]]


def turned(angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


class Textbook:
    """Kalman filter with the matrices of a textbook, inverses and all."""

    def __init__(self, z: Array, noise: Array, ray: Array, spread: float) -> None:
        self.x = np.concatenate([z[:2], [0, 0]])
        self.P = np.diag([0, 0, spread**2, spread**2]).astype(float)
        self.P[:2, :2] = noise[:2, :2]
        if len(z) == 3:
            self.correct(z[2:], np.array([[0, 0, *ray]]), noise[2:, 2:])

    def predict(self, moved: Array, angle: float, sigma: float) -> None:
        back, eye = turned(-angle), np.eye(2)
        F = np.kron(np.eye(2), back) @ np.block([[eye, T * eye], [0 * eye, eye]])
        G = np.vstack([T**2 / 2 * eye, T * eye])
        self.x = F @ (self.x - np.concatenate([moved, [0, 0]]))
        self.P = F @ self.P @ F.T + sigma**2 * G @ G.T

    def correct(self, z: Array, H: Array, R: Array) -> None:
        K = self.P @ H.T @ np.linalg.inv(H @ self.P @ H.T + R)
        self.x = self.x + K @ (z - H @ self.x)
        keep = np.eye(4) - K @ H
        self.P = keep @ self.P @ keep.T + K @ R @ K.T  # Joseph's form


def test_the_filter_equals_a_textbook_one_with_two_sensors_on_a_turning_car(new_part: NewPart) -> None:
    random = np.random.default_rng(3)
    part = new_part("kalman_tracker", gate=1e9, confirm=1, of=1, first_period=0.08, second_period=0.04)
    sensors = {}
    for number, name in enumerate(("first", "second")):
        par = {
            k: part[f"{name}_{k}"] for k in ("mount", "range_noise", "relative_noise", "azimuth_noise", "doppler_noise")
        }
        sensors[name] = (par, 4 if number == 0 else 2)
    own, velocity = np.array([0.0, 0.0, 0.3]), np.array([12.0, 3.0])
    thing = np.array([50.0, 20.0])
    book: Textbook | None = None
    last = (20.0, 0.3, 0.2)
    for k in range(200):
        motion = (20 - 3 * T * k, 0.3 * math.cos(k / 20), 0.2 + 0.1 * math.sin(k / 30))
        drive(part, *motion)
        speed, aside, rate = (np.array(motion) + np.array(last)) / 2
        n = 2000  # the arc of a step by the midpoint rule: the means of motion at both ends
        ticks = (np.arange(n) + 0.5) * T / n
        along = np.array([np.mean(np.cos(rate * ticks)), np.mean(np.sin(rate * ticks))]) * T
        moved = np.array([speed * along[0] - aside * along[1], speed * along[1] + aside * along[0]])
        if k:
            own = np.array([*(own[:2] + turned(own[2]) @ moved), own[2] + rate * T])
            thing = thing + velocity * T
            assert book is not None
            book.predict(moved, rate * T, part["acceleration_noise"])
        last = motion
        for name, (par, every) in sensors.items():
            x, y = turned(-own[2]) @ (thing - own[:2]) - np.array([par["mount"], 0])
            r = math.hypot(x, y) + random.normal(0, 0.2)
            a = math.atan2(y, x) + random.normal(0, 0.002)
            ray = np.array([math.cos(a), math.sin(a)])
            base = np.array([motion[0], motion[1] + motion[2] * par["mount"]])
            rate_seen = (turned(-own[2]) @ velocity - base) @ ray + random.normal(0, 0.1)
            see(part, name, (1.0, 0.0), range=r, azimuth=a, range_rate=rate_seen)
            if k % every:
                continue  # told, but it is not the sensor's turn
            J = np.column_stack([ray, [-r * ray[1], r * ray[0]]])
            R = (
                J
                @ np.diag([par["range_noise"] ** 2 + (par["relative_noise"] * r) ** 2, par["azimuth_noise"] ** 2])
                @ J.T
            )
            z, H = np.array([par["mount"] + r * ray[0], r * ray[1]]), np.eye(2, 4)
            if par["doppler_noise"] > 0:
                z, H = np.append(z, rate_seen + base @ ray), np.vstack([H, [0, 0, *ray]])
                R = np.block([[R, np.zeros((2, 1))], [np.zeros((1, 2)), np.array([[par["doppler_noise"] ** 2]])]])
            if book is None:
                book = Textbook(z, R, ray, part["speed_deviation"])
            else:
                book.correct(z, H, R)
        part.init() if k == 0 else part.step()
        (track,) = tracks(part)
        assert book is not None
        np.testing.assert_allclose([track[key] for key in ("x", "y", "vx", "vy")], book.x, rtol=0, atol=1e-9)
    assert track["id"] == 1
    assert track["age"] == pytest.approx(199 * T)
    over_ground = turned(-own[2]) @ velocity
    assert [track["vx"], track["vy"]] == pytest.approx(list(over_ground), abs=0.5)  # and the truth


def test_a_post_stands_still_for_a_car_that_brakes_in_a_curve(new_part: NewPart) -> None:
    part = new_part("kalman_tracker", **{**QUIET, **FAST})
    x, y, heading, speed = 0.0, 0.0, 0.0, 20.0
    for k in range(150):
        drive(part, speed, 0.0, 0.3)
        c, s = math.cos(heading), math.sin(heading)
        dx, dy = 60 - x, 10 - y
        see(part, "first", (c * dx + s * dy, c * dy - s * dx))
        part.init() if k == 0 else part.step()
        for _ in range(100):  # the drive in small steps
            heading += 0.3 * T / 200
            x, y = x + speed * T / 100 * math.cos(heading), y + speed * T / 100 * math.sin(heading)
            heading += 0.3 * T / 200
            speed -= 4 * T / 100
    (track,) = tracks(part)
    assert [track["vx"], track["vy"]] == pytest.approx([0, 0], abs=2e-3)
    assert math.hypot(track["x"] - (c * dx + s * dy), track["y"] - (c * dy - s * dx)) < 1e-3


def test_errors_are_as_large_as_the_filter_believes(new_part: NewPart) -> None:
    """From a standing car, at rest: the steady error of place by the Riccati equation, with 99.7 % confidence."""
    noise, n = 0.5, 6000
    part = new_part("kalman_tracker", **{**QUIET, **FAST}, gate=1e9, confirm=1, of=1)
    part["first_range_noise"], part["first_azimuth_noise"], part["acceleration_noise"] = noise, 1e-4, 3.0
    random, errors = np.random.default_rng(5), []
    for k in range(n):
        see(part, "first", (40 + random.normal(0, noise), 0.0))
        part.init() if k == 0 else part.step()
        errors.append(tracks(part)[0]["x"] - 40)
    # A standing object is the filter x+ = (I - K H) F x + K z with the gain of its Riccati equation.
    F, H, P = np.array([[1, T], [0, 1]]), np.array([[1.0, 0]]), np.eye(2)
    Q = 9 * np.outer([T**2 / 2, T], [T**2 / 2, T])
    for _ in range(3000):
        M = F @ P @ F.T + Q
        K = M @ H.T / (H @ M @ H.T + noise**2)
        P = (np.eye(2) - K @ H) @ M
    A, C = (np.eye(2) - K @ H) @ F, np.zeros((2, 2))
    covs = []
    for _ in range(3000):
        C = A @ C @ A.T + noise**2 * K @ K.T
    row = C
    for _ in range(2000):
        covs.append(row[0, 0])
        row = A @ row
    variance = C[0, 0]
    # The variance of the mean of squares of a correlated normal series: 2 sum(cov^2) / n.
    spread = math.sqrt(2 * (2 * float(np.sum(np.square(covs))) - variance**2) / (n - 1000))
    assert abs(np.mean(np.square(errors[1000:])) - variance) < 3 * spread
    assert variance < noise**2 / 5


@pytest.mark.parametrize(("hits", "confirmed"), [("11100", True), ("10101", True), ("10100", False), ("10010", False)])
def test_a_track_is_told_of_when_three_of_five_looks_hit_it(new_part: NewPart, hits: str, confirmed: bool) -> None:
    part = new_part("kalman_tracker", **{**QUIET, **FAST})
    told = []
    for k, hit in enumerate(hits):
        see(part, "first", *([(40.0, 2.0)] if hit == "1" else []))
        part.init() if k == 0 else part.step()
        told.append(bool(tracks(part)))
    assert told == [hits[: k + 1].count("1") >= 3 for k in range(5)]
    assert any(told) == confirmed
    see(part, "first")
    for _ in range(40):
        part.step()
    assert tracks(part) == []


def test_a_track_coasts_through_a_gap_and_is_forgotten_after_a_longer_one(new_part: NewPart) -> None:
    part = new_part("kalman_tracker", **{**QUIET, **FAST}, coast=0.3)
    for k in range(100):
        see(part, "first", (40.0 + 10 * T * k, 2.0))
        part.init() if k == 0 else part.step()
    see(part, "first")
    for _ in range(14):
        part.step()
    (track,) = tracks(part)
    assert track["x"] == pytest.approx(40 + 10 * T * 113, abs=0.05)
    part.step()
    part.step()
    assert tracks(part) == []


def test_ids_stay_with_two_that_cross_and_an_outlier_is_not_taken(new_part: NewPart) -> None:
    part = new_part("kalman_tracker", **{**QUIET, **FAST})
    for k in range(201):
        y = 6 - 12 * k / 200
        places = [(30.0, y), (31.0, -y)]
        see(part, "first", *(places if k % 2 else reversed(places)))
        part.init() if k == 0 else part.step()
        if k == 90:
            before = {round(track["y"]): track["id"] for track in tracks(part)}
    after = {round(track["y"]): track["id"] for track in tracks(part)}
    assert before[1] == after[-6]
    assert before[-1] == after[6]
    see(part, "first", (30.0, -6.06), (36.0, 6.06))  # five metres off
    part.step()
    assert sorted(round(track["x"]) for track in tracks(part)) == [30, 31]


def test_the_second_sensor_gives_class_and_width_to_what_the_first_has_found(new_part: NewPart) -> None:
    part = new_part("kalman_tracker", **FAST)
    for k in range(20):
        see(part, "first", (38.0, 1.0))
        see(part, "second", (39.8, 1.0), **{"class": "pedestrian", "width": 0.4 + 0.2 * (k % 2)})
        part.init() if k == 0 else part.step()
    (track,) = tracks(part)
    assert (track["class"], track["width"]) == (5, pytest.approx(0.5, abs=0.03))


def test_the_nearest_eight_are_told_of_nearest_first(new_part: NewPart) -> None:
    part = new_part("kalman_tracker", **{**QUIET, **FAST})
    places = [(20.0 + 7 * k, (-1) ** k * 4.0) for k in range(12)]
    for k in range(6):
        see(part, "first", *places[::-1])
        part.init() if k == 0 else part.step()
    assert [round(track["x"]) for track in tracks(part)] == [round(x) for x, _ in places[:8]]


def test_no_tracker_passes_the_nearest_detections_on(new_part: NewPart) -> None:
    part = new_part("no_tracker", mount=2.0)
    drive(part, 20.0, 0.0, 0.1)
    see(part, "first", (30.0, 3.0), (60.0, -4.0))
    for number, (x, y) in enumerate(((30.0, 3.0), (60.0, -4.0)), 1):  # both drive 15 m/s along the car
        part[f"first[{number}].range_rate"] = ((15 - 20) * x - 0.1 * 2 * y) / math.hypot(x, y)
        part[f"first[{number}].class"] = "truck"
    part.init()
    for track, (x, y) in zip(tracks(part), ((32.0, 3.0), (62.0, -4.0)), strict=True):
        wanted = {"x": x, "y": y, "vx": 15.0, "vy": 0.0, "age": 0.0}
        assert {key: track[key] for key in wanted} == pytest.approx(wanted, abs=1e-12)
        assert track["class"] == 2
    see(part, "first", *[(10.0 + k, 0.0) for k in range(10)])
    part.step()
    assert [track["x"] for track in tracks(part)] == [12.0 + k for k in range(8)]
    part["doppler"] = False
    part.step()
    assert {track["vx"] for track in tracks(part)} == {0.0}
