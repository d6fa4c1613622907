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
Motion = tuple[float, float, float]
T = 0.02
NOISES = {
    "first": {"range_deviation": 0.1, "azimuth_deviation": math.radians(0.1), "rate_deviation": 0.0},
    "second": {"range_deviation": 0.2, "azimuth_deviation": math.radians(0.05), "rate_deviation": 0.0},
}
QUIET = {"acceleration_noise": 1.0}
NAMES = ("x", "y", "vx", "vy")
COVARIANCE = [f"covariance.{one}_{other}" for i, one in enumerate(NAMES) for other in NAMES[i:]]
UPPER = np.triu_indices(4)


def drive(part: Any, speed: float = 0.0, aside: float = 0.0, yaw_rate: float = 0.0) -> None:
    part["motion.speed"], part["motion.lateral_speed"], part["motion.yaw_rate"] = speed, aside, yaw_rate


def see(part: Any, sensor: str, *places: tuple[float, float], **values: Any) -> None:
    """A new scan: detections at places ahead and to the left of the sensor."""
    part[f"{sensor}.number"] += 1
    for number in range(1, 17):
        part[f"{sensor}.returns[{number}].valid"] = number <= len(places)
    for number, (x, y) in enumerate(places, 1):
        told = {"range": math.hypot(x, y), "azimuth": math.atan2(y, x), "range_rate": 0.0, **NOISES[sensor], **values}
        for key, value in told.items():
            part[f"{sensor}.returns[{number}].{key}"] = value


def advance(part: Any, k: int) -> None:
    if k == 0:
        part.init()
    part.step()


def tracks(part: Any) -> list[dict[str, Any]]:
    keys = ("id", "class", "x", "y", "vx", "vy", "ax", "ax_deviation", "width", "age", "existence", *COVARIANCE)
    found = [{key: part[f"tracks[{i}].{key}"] for key in keys} for i in range(1, 9)]
    return [track for track in found if track["id"]]


def turned(angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


class Textbook:
    """Kalman filter with the matrices of a textbook, inverses and all.

    *lasting*: deviations and correlation times (0: constant) of errors that the measurements of a sensor have in
    common. *arm*: derivatives of a measured place by them.
    """

    def __init__(
        self, z: Array, noise: Array, ray: Array, spread: float, lasting: Array | None = None, arm: Array | None = None
    ) -> None:
        self.lasting = np.zeros((0, 2)) if lasting is None else lasting
        arm = np.zeros((2, len(self.lasting))) if arm is None else arm
        self.x = np.concatenate([z[:2], [0, 0], 0 * self.lasting[:, 0]])
        self.P = np.diag([0, 0, spread**2, spread**2, *self.lasting[:, 0] ** 2]).astype(float)
        self.P[:2, :2] = noise[:2, :2] + arm @ self.P[4:, 4:] @ arm.T
        self.P[:2, 4:] = -arm @ self.P[4:, 4:]
        self.P[4:, :2] = self.P[:2, 4:].T
        if len(z) == 3:
            self.correct(z[2:], np.array([[0, 0, *ray]]), noise[2:, 2:])

    def move(self, F: Array, Q: Array, fades: Array) -> None:
        """By matrices of place and velocity, and by what remains of the errors that last."""
        whole, more = np.diag([0.0] * 4 + list(fades)), np.diag([0.0] * 4 + list(1 - fades**2))
        whole[:4, :4], more[:4, :4] = F, 0
        more[4:, 4:] *= self.lasting[:, 0] ** 2
        more[:4, :4] = Q
        self.x, self.P = whole @ self.x, whole @ self.P @ whole.T + more

    def predict(self, moved: Array, angle: float, sigma: float) -> None:
        back, eye = turned(-angle), np.eye(2)
        F = np.kron(np.eye(2), back) @ np.block([[eye, T * eye], [0 * eye, eye]])
        G = np.vstack([T**2 / 2 * eye, T * eye])
        self.x[:2] -= moved
        times = self.lasting[:, 1]
        self.move(F, sigma**2 * G @ G.T, np.exp(-T / np.where(times > 0, times, np.inf)))

    def correct(self, z: Array, H: Array, R: Array) -> float:
        """Returns the squared innovation, normalised by its covariance."""
        H = np.hstack([H, np.zeros((len(z), len(self.x) - H.shape[1]))])
        S, error = H @ self.P @ H.T + R, z - H @ self.x
        K = self.P @ H.T @ np.linalg.inv(S)
        self.x = self.x + K @ error
        keep = np.eye(len(self.x)) - K @ H
        self.P = keep @ self.P @ keep.T + K @ R @ K.T  # Joseph's form
        return float(error @ np.linalg.solve(S, error))

    def spread(self, length: float, width: float, heading: float) -> None:
        """The place may be that of any point of a rectangle: its covariance is the rectangle's second moment."""
        places = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]) * np.array([length, width]) / 2
        weights = np.outer(np.array([1, 4, 1]) / 6, np.array([1, 4, 1]) / 6).ravel()  # Simpson's, exact for squares
        places = places @ turned(heading).T
        self.P[:2, :2] += (places * weights[:, None]).T @ places


def arc(first: Motion, last: Motion, duration: float) -> tuple[Array, float]:
    """Moved and turned, by the midpoint rule, at the mean of two motions."""
    speed, aside, rate = (np.array(first) + np.array(last)) / 2
    n = 2000
    ticks = (np.arange(n) + 0.5) * duration / n
    c, s = np.mean(np.cos(rate * ticks)) * duration, np.mean(np.sin(rate * ticks)) * duration
    return np.array([speed * c - aside * s, speed * s + aside * c]), rate * duration


def arm_of(place: Array, sensor: Array, number: int) -> Array:
    """How errors of scale and azimuth of sensor 0 or 1 move a *place* that it measures."""
    arm = np.zeros((2, 4))
    arm[:, 2 * number : 2 * number + 2] = np.column_stack([place - sensor, turned(math.pi / 2) @ (place - sensor)])
    return arm


def declare(part: Any, lasting: Array) -> None:
    errors = [f"{sensor}.{error}" for sensor in NOISES for error in ("scale", "misalignment")]
    for error, (deviation, time) in zip(errors, lasting, strict=True):
        part[f"{error}.deviation"], part[f"{error}.time"] = deviation, time


@pytest.mark.parametrize(
    "lasting", [np.zeros((4, 2)), np.array([[0.02, 0.7], [0.004, 0.0], [0.05, 0.0], [0.003, 1.5]])], ids=["no", "some"]
)
def test_the_filter_equals_a_textbook_one_with_two_late_sensors_on_a_turning_car(
    new_part: NewPart, lasting: Array
) -> None:
    random = np.random.default_rng(3)
    part = new_part("kalman_tracker", gate=1e9, confirm=1, of=1)
    declare(part, lasting)
    # Mount, period and age in steps, noises: the second one's age lies between two steps.
    sensors: dict[str, tuple[float, int, float, dict[str, float]]] = {
        "first": (2.3, 4, 4.0, {"range_deviation": 0.1, "azimuth_deviation": 0.0017, "rate_deviation": 0.12}),
        "second": (0.5, 2, 2.5, {"range_deviation": 1.4, "azimuth_deviation": 0.0009, "rate_deviation": 0.0}),
    }
    place, heading, velocity, thing = np.zeros(2), 0.3, np.array([12.0, 3.0]), np.array([50.0, 20.0])
    past: list[tuple[Array, float, Motion]] = []
    book: Textbook | None = None
    for k in range(200):
        motion = (20 - 3 * T * k, 0.3 * math.cos(k / 20), 0.2 + 0.1 * math.sin(k / 30))
        drive(part, *motion)
        if k:
            moved, angle = arc(past[-1][2], motion, T)
            place, heading, thing = place + turned(heading) @ moved, heading + angle, thing + velocity * T
            if book is not None:
                book.predict(moved, angle, part["acceleration_noise"])
        past.append((place, heading, motion))
        for number, (name, (mount, every, age, noises)) in enumerate(sensors.items()):
            if k < 4 or k % every:
                part[f"{name}.age"] += T  # what was told already, and is not read again
                continue
            stood, pointed, was = past[k - int(age)]
            share = age - int(age)
            if share:  # back from the step behind it, at a motion between both
                before = past[k - int(age) - 1][2]
                between = (was[0] * (1 - share) + before[0] * share, was[1] * (1 - share) + before[1] * share, 0.0)
                between = (*between[:2], was[2] * (1 - share) + before[2] * share)
                moved, angle = arc(between, was, share * T)
                pointed -= angle
                stood, was = stood - turned(pointed) @ moved, between
            x, y = turned(-pointed) @ (thing - velocity * age * T - stood) - np.array([mount, 0])
            r, a = math.hypot(x, y) + random.normal(0, 0.2), math.atan2(y, x) + random.normal(0, 0.002)
            ray = np.array([math.cos(a), math.sin(a)])
            base = np.array([was[0], was[1] + was[2] * mount])
            rate_seen = (turned(-pointed) @ velocity - base) @ ray + random.normal(0, 0.1)
            see(part, name, (1.0, 0.0), range=r, azimuth=a, range_rate=rate_seen, **noises)
            part[f"{name}.age"], part[f"{name}.mount"] = age * T, mount
            # In the plane, and from there into the car of now.
            seen = stood + turned(pointed) @ (np.array([mount, 0]) + r * ray)
            z, ray = turned(-heading) @ (seen - place), turned(pointed - heading) @ ray
            J = np.column_stack([ray, r * np.array([-ray[1], ray[0]])])
            R = J @ np.diag([noises["range_deviation"] ** 2, noises["azimuth_deviation"] ** 2]) @ J.T
            H = np.block([np.eye(2), -age * T * np.eye(2)])
            if noises["rate_deviation"] > 0:
                own_speed = base @ turned(heading - pointed) @ ray
                z, H = np.append(z, rate_seen + own_speed), np.vstack([H, [0, 0, *ray]])
                R = np.block([[R, np.zeros((2, 1))], [np.zeros((1, 2)), np.array([[noises["rate_deviation"] ** 2]])]])
            sensor = turned(-heading) @ (stood + turned(pointed) @ np.array([mount, 0]) - place)
            if book is None:
                book = Textbook(z, R, ray, part["speed_deviation"], lasting, arm_of(z[:2], sensor, number))
                F = np.block([[np.eye(2), age * T * np.eye(2)], [np.zeros((2, 2)), np.eye(2)]])
                book.move(F, np.zeros((4, 4)), np.ones(4))
            else:
                arm = arm_of(book.x[:2] - age * T * book.x[2:4], sensor, number)
                book.correct(z, np.hstack([H, np.vstack([arm, np.zeros((len(z) - 2, 4))])]), R)
        advance(part, k)
        if book is None:
            continue
        (track,) = tracks(part)
        np.testing.assert_allclose([track[key] for key in NAMES], book.x[:4], rtol=0, atol=1e-9)
        told = [track[key] for key in COVARIANCE]
        np.testing.assert_allclose(told, book.P[:4, :4][UPPER], rtol=1e-7, atol=1e-9)
    assert (track["id"], track["age"]) == (1, pytest.approx(195 * T))
    over_ground = turned(-heading) @ velocity
    if not lasting.any():
        assert [track["vx"], track["vy"]] == pytest.approx(list(over_ground), abs=0.5)  # and the truth
        assert [track["x"], track["y"]] == pytest.approx(list(turned(-heading) @ (thing - place)), abs=0.4)


@pytest.mark.parametrize("rate_deviation", [0.1, 0.0])
def test_the_acceleration_is_that_of_one_filter_with_the_acceleration_as_a_state(
    new_part: NewPart, rate_deviation: float
) -> None:
    """Friedland: of a constant bias, both stages together equal the augmented filter. A car ahead brakes at 4 m/s2."""
    part = new_part("kalman_tracker", gate=1e9, confirm=1, of=1, acceleration_time=1e12)
    random, ahead, age, yaw_rate, along = np.random.default_rng(5), np.array([1.0, 0.0]), 0.05, 0.1, 4.0
    move, angle = arc((20.0, 0.0, yaw_rate), (20.0, 0.0, yaw_rate), T)
    back, q = turned(-angle), part["acceleration_noise"] ** 2
    F, Q = np.eye(5), np.zeros((5, 5))
    F[:4, :4] = np.block([[back, T * back], [np.zeros((2, 2)), back]])
    F[:2, 4], F[2:4, 4] = back @ ahead * T**2 / 2, back @ ahead * T
    for i in range(2):
        Q[np.ix_([i, 2 + i], [i, 2 + i])] = q * np.array([[T**4 / 4, T**3 / 2], [T**3 / 2, T**2]])
    truth, book, P = np.array([30.0, 1.0, 18.0, 0.0, -along]), np.zeros(5), np.zeros((5, 5))
    then, turn = arc((20.0, 0.0, yaw_rate), (20.0, 0.0, yaw_rate), age)
    for k in range(150):
        drive(part, 20.0, 0.0, yaw_rate)
        if k:
            truth = F @ truth
            truth[:2] -= back @ move
        if k >= 12 and k % 3 == 0:
            place = truth[:2] - age * truth[2:4] + age**2 / 2 * truth[4] * ahead
            x, y = turned(turn) @ place + then  # on the car as it was
            r, a = math.hypot(x, y) + random.normal(0, 0.1), math.atan2(y, x) + random.normal(0, 0.002)
            seen = np.array([math.cos(a), math.sin(a)])
            ray = turned(-turn) @ seen
            speed = (truth[2:4] - age * truth[4] * ahead) @ ray + random.normal(0, 0.1)
            noises = {**NOISES["first"], "rate_deviation": rate_deviation}
            see(part, "first", (1.0, 0.0), range=r, azimuth=a, range_rate=speed - 20 * seen[0], **noises)
            part["first.age"], part["first.mount"] = age, 0.0
        advance(part, k)
        if k < 12:
            continue
        (track,) = tracks(part)
        if k == 12:  # as it begins, without any knowledge of the acceleration
            book[:4] = [track[key] for key in NAMES]
            P[UPPER] = [track[key] for key in COVARIANCE]
            P += np.triu(P, 1).T
            P[4, 4] = part["acceleration_deviation"] ** 2
            continue
        book, P = F @ book, F @ P @ F.T + Q
        book[:2] -= back @ move
        if k % 3 == 0:
            H = np.zeros((3, 5))
            H[:2] = np.column_stack([np.eye(2), -age * np.eye(2), age**2 / 2 * ahead])
            H[2, 2:] = [*ray, -age * ray[0]]
            J = np.column_stack([ray, r * np.array([-ray[1], ray[0]])])
            R = np.zeros((3, 3))
            R[:2, :2] = J @ np.diag([0.1**2, noises["azimuth_deviation"] ** 2]) @ J.T
            R[2, 2] = rate_deviation**2
            z, used = np.array([*(turned(-turn) @ (r * seen - then)), speed]), 3 if rate_deviation else 2
            H, R, z = H[:used], R[:used, :used], z[:used]
            gain = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
            book, P = book + gain @ (z - H @ book), P - gain @ H @ P
        assert track["ax"] == pytest.approx(book[4], abs=1e-6)
        assert track["ax_deviation"] ** 2 == pytest.approx(P[4, 4], rel=1e-6)
    assert track["ax"] == pytest.approx(-along, abs=3 * track["ax_deviation"])
    assert track["ax_deviation"] < 0.5 * part["acceleration_deviation"]


@pytest.mark.parametrize(("kind", "body"), [("truck", (16.0, 2.55)), ("none", (16.0, 2.55)), ("car", (4.5, 1.8))])
def test_what_shows_another_face_moves_its_place_and_hardly_its_speed(
    new_part: NewPart, kind: str, body: tuple[float, float]
) -> None:
    """Seen from a standing car with Doppler: the place leaps by half the body, and equals that of a textbook."""
    part, noises = new_part("kalman_tracker", **QUIET, confirm=1, of=1), NOISES["first"] | {"rate_deviation": 0.1}
    heading, book = 0.3, None
    way = np.array([math.cos(heading), math.sin(heading)])
    for k in range(60):
        x, y = np.array([20.0, 4.0]) + 15 * T * k * way + (k >= 40) * turned(heading) @ np.array(body) / 2
        r, a = math.hypot(x, y), math.atan2(y, x)
        ray, rate = np.array([x, y]) / r, 15 * math.cos(a - heading)
        see(part, "first", (x, y), **{"class": kind, "range_rate": rate, "rate_deviation": 0.1})
        advance(part, k)
        J = np.column_stack([ray, r * np.array([-ray[1], ray[0]])])
        R = np.zeros((3, 3))
        R[:2, :2] = J @ np.diag(
            [noises["range_deviation"] ** 2, noises["azimuth_deviation"] ** 2]
        ) @ J.T + 1e-12 * np.eye(2)
        R[2, 2] = 0.1**2
        z, H = np.array([x, y, rate]), np.vstack([np.eye(4)[:2], [0, 0, *ray]])
        if book is None:
            book = Textbook(z, R, ray, part["speed_deviation"])
        else:
            book.predict(np.zeros(2), 0.0, part["acceleration_noise"])
            if k == 40:
                before = book.x.copy()
                book.spread(*body, math.atan2(book.x[3], book.x[2]))
            book.correct(z, H, R)
            if k == 40:
                book.P[2:, 2:] += 0.3**2 * np.eye(2)  # it may be turning
                assert np.linalg.norm(book.x[:2] - before[:2]) == pytest.approx(math.hypot(*body) / 2, abs=0.5)
                assert np.linalg.norm(book.x[2:] - before[2:]) < 0.2
        (track,) = tracks(part)
        np.testing.assert_allclose([track[key] for key in NAMES], book.x, rtol=0, atol=1e-9)
    assert track["id"] == 1


def test_two_cars_side_by_side_stay_two_though_each_is_missed_now_and_then(new_part: NewPart) -> None:
    """In adjoining lanes, 3.5 m apart and as fast as each other; one shows up beside the other when that is missed."""
    part = new_part("kalman_tracker", **QUIET)
    for k in range(100):
        places = [(30.0, 0.0)] if k < 20 else [(30.0, 3.5)] if k < 23 else [(30.0, 0.0), (30.0, 3.5)]
        places = places[:1] if k > 23 and k % 10 == 0 else places[1:] if k > 23 and k % 10 == 5 else places
        see(part, "first", *places, **{"class": "car", "rate_deviation": 0.1})
        advance(part, k)
        if k > 25:
            assert sorted((track["id"], round(track["y"], 1)) for track in tracks(part)) == [(1, 0.0), (2, 3.5)]


BODIES: dict[str, dict[str, Any]] = {
    "car": {"class": "car", "length": 4.5, "width": 1.8, "height": 1.5},
    "truck": {"class": "truck", "length": 16.0, "width": 2.55, "height": 3.8},
}


def passed(
    new_part: NewPart, eyes: list[str], kind: str, aside: float, faster: float
) -> tuple[list[set[int]], set[int]]:
    """One vehicle beside the car at 100 km/h: the tracks told of, step by step, and all that the brake does."""
    own, end = 100 / 3.6, 20.0 if abs(faster) < 2 else 14.0
    parts, tracker, brake = [new_part(eye) for eye in eyes], new_part("kalman_tracker"), new_part("two_stage_aeb")
    begin = -7 * faster - (5 if faster > 0 else -5)
    for eye in parts:
        if "ghost_share" in eye.slots:
            eye["ghost_share"] = 0.0
    wires = [(eye, name, [key for key in eye.slots if key.startswith("scan.")])
             for eye, name in zip(parts, ("first", "second"), strict=False)]  # fmt: skip
    ids, stages = [], set()
    for k in range(int(end / 0.01)):
        for part in (*parts, tracker, brake):
            part["motion.x"], part["motion.speed"] = own * 0.01 * k, own
        for eye in parts:
            body = {**BODIES[kind], "x": own * 0.01 * k + begin + faster * 0.01 * k, "y": aside, "speed": own + faster}
            for key, value in body.items():
                eye[f"actors[1].{key}"] = value
            advance(eye, k)
        if k % 2 == 0:
            for eye, name, keys in wires:
                for key in keys:
                    tracker[name + key.removeprefix("scan")] = eye[key]
            advance(tracker, k)
        for key in (key for key in brake.slots if key.startswith("tracks")):
            brake[key] = tracker[key]
        advance(brake, k)
        ids.append({tracker[f"tracks[{i}].id"] for i in range(1, 9)} - {0})
        stages.add(brake["stage"])
    return ids, stages


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    "eyes",
    [["object_perfect"], ["object_radar_long"], ["object_radar_mid", "object_camera"]],
    ids="+".join,
)
@pytest.mark.parametrize(("kind", "faster"), [("truck", -5), ("truck", -10), ("truck", -15), ("car", -15), ("car", 15)])
def test_who_is_passed_on_the_next_lane_or_passes_is_one_track_and_none_to_brake_for(
    new_part: NewPart, eyes: list[str], kind: str, faster: float
) -> None:
    """Rear, side, front: while the seen face changes, and part of the body leaves the field of view."""
    ids, stages = passed(new_part, eyes, kind, 3.75, faster / 3.6)
    assert max(len(told) for told in ids) == 1
    assert len(set().union(*ids)) == 1
    assert stages == {0}


def test_a_post_stands_still_for_a_car_that_brakes_in_a_curve(new_part: NewPart) -> None:
    part = new_part("kalman_tracker", **QUIET)
    x, y, heading, speed = 0.0, 0.0, 0.0, 20.0
    for k in range(150):
        drive(part, speed, 0.0, 0.3)
        c, s = math.cos(heading), math.sin(heading)
        dx, dy = 60 - x, 10 - y
        see(part, "first", (c * dx + s * dy, c * dy - s * dx))
        advance(part, k)
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
    part = new_part("kalman_tracker", **QUIET, gate=1e9, confirm=1, of=1)
    part["acceleration_noise"] = 3.0
    random, errors = np.random.default_rng(5), []
    for k in range(n):
        see(part, "first", (40 + random.normal(0, noise), 0.0), range_deviation=noise, azimuth_deviation=1e-4)
        advance(part, k)
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
    part = new_part("kalman_tracker", **QUIET)
    told = []
    for k, hit in enumerate(hits):
        see(part, "first", *([(40.0, 2.0)] if hit == "1" else []))
        advance(part, k)
        told.append(bool(tracks(part)))
    assert told == [hits[: k + 1].count("1") >= 3 for k in range(5)]
    assert any(told) == confirmed
    see(part, "first")
    for _ in range(40):
        part.step()
    assert tracks(part) == []


def test_a_track_coasts_through_a_gap_and_is_forgotten_after_a_longer_one(new_part: NewPart) -> None:
    part = new_part("kalman_tracker", **QUIET, coast=0.3)
    for k in range(100):
        see(part, "first", (40.0 + 10 * T * k, 2.0))
        advance(part, k)
    see(part, "first")
    for _ in range(14):
        part.step()
    (track,) = tracks(part)
    assert track["x"] == pytest.approx(40 + 10 * T * 113, abs=0.05)
    part.step()
    part.step()
    assert tracks(part) == []


def test_ids_stay_with_two_that_cross_and_an_outlier_is_not_taken(new_part: NewPart) -> None:
    part = new_part("kalman_tracker", **QUIET)
    for k in range(201):
        y = 6 - 12 * k / 200
        places = [(30.0, y), (31.0, -y)]
        see(part, "first", *(places if k % 2 else reversed(places)))
        advance(part, k)
        if k == 90:
            before = {round(track["y"]): track["id"] for track in tracks(part)}
    after = {round(track["y"]): track["id"] for track in tracks(part)}
    assert before[1] == after[-6]
    assert before[-1] == after[6]
    see(part, "first", (30.0, -6.06), (36.0, 6.06))  # five metres off
    part.step()
    assert sorted(round(track["x"]) for track in tracks(part)) == [30, 31]


def test_the_second_sensor_gives_class_and_width_to_what_the_first_has_found(new_part: NewPart) -> None:
    part = new_part("kalman_tracker")
    part["first.mount"], part["second.mount"] = 2.3, 0.5
    for k in range(20):
        see(part, "first", (38.0, 1.0))
        see(part, "second", (39.8, 1.0), **{"class": "pedestrian", "width": 0.4 + 0.2 * (k % 2)})
        advance(part, k)
    (track,) = tracks(part)
    assert (track["class"], track["width"]) == (5, pytest.approx(0.5, abs=0.03))


def test_the_nearest_eight_are_told_of_nearest_first(new_part: NewPart) -> None:
    part = new_part("kalman_tracker", **QUIET)
    places = [(20.0 + 7 * k, (-1) ** k * 4.0) for k in range(12)]
    for k in range(6):
        see(part, "first", *places[::-1])
        advance(part, k)
    assert [round(track["x"]) for track in tracks(part)] == [round(x) for x, _ in places[:8]]


def test_no_tracker_passes_the_nearest_detections_on(new_part: NewPart) -> None:
    part = new_part("no_tracker")
    part.init()
    assert tracks(part) == []
    drive(part, 20.0, 0.0, 0.1)
    see(part, "first", (30.0, 3.0), (60.0, -4.0))
    part["first.mount"] = 2.0
    for number, (x, y) in enumerate(((30.0, 3.0), (60.0, -4.0)), 1):  # both drive 15 m/s along the car
        part[f"first.returns[{number}].range_rate"] = ((15 - 20) * x - 0.1 * 2 * y) / math.hypot(x, y)
        part[f"first.returns[{number}].rate_deviation"] = 0.1
        part[f"first.returns[{number}].class"] = "truck"
    part.init()
    part.step()
    for track, (x, y) in zip(tracks(part), ((32.0, 3.0), (62.0, -4.0)), strict=True):
        wanted = {"x": x, "y": y, "vx": 15.0, "vy": 0.0, "age": 0.0}
        assert {key: track[key] for key in wanted} == pytest.approx(wanted, abs=1e-12)
        assert track["class"] == 2
    see(part, "first", *[(10.0 + k, 0.0) for k in range(10)], rate_deviation=0.1)
    part.step()
    assert [track["x"] for track in tracks(part)] == [12.0 + k for k in range(8)]
    part["first.returns[1].rate_deviation"] = 0.0
    part.step()
    assert tracks(part)[0]["vx"] == 0.0
    part["first.number"] = 0
    part.step()
    assert tracks(part) == []


def test_what_no_tracker_passes_on_is_moved_by_its_age(new_part: NewPart) -> None:
    """A car that drives an arc, and one that goes straight on at 15 m/s: where it is now, from a scan of 80 ms ago."""
    part = new_part("no_tracker")
    drive(part, 20.0, 0.0, 0.2)
    part["first.age"] = 0.08
    see(part, "first", (30.0, 0.0), range_rate=-5.0, rate_deviation=0.1)
    part.init()
    for _ in range(10):
        part.step()
    moved, angle = arc((20.0, 0.0, 0.2), (20.0, 0.0, 0.2), 0.08)
    (track,) = tracks(part)
    x, y = turned(-angle) @ (np.array([30.0, 0.0]) - moved)
    speed = 15.0 / math.cos(angle)  # taken to drive along the car, seen along a ray that is turned by now
    assert [track["x"], track["y"], track["vx"]] == pytest.approx([x + 0.08 * speed, y, speed], abs=1e-8)


def followed(new_part: NewPart, eye: Any, seed: int, speed: float) -> tuple[list[float], Array, int]:
    """From a standing car, an object whose velocity changes at random as the tracker assumes, seen for ten seconds.

    Returns the normalised squared innovations of an own filter, errors over covariance of the tracker's last estimate,
    and the number of tracks there were.
    """
    random = np.random.default_rng(seed)
    tracker = new_part("kalman_tracker", gate=1e9, confirm=1, of=1, coast=10.0, speed_deviation=speed)
    eye.init()
    sigma, mount = tracker["acceleration_noise"], eye["mount"]
    lasting = np.array([[eye[f"scan.{error}.{key}"] for key in ("deviation", "time")]
                        for error in ("scale", "misalignment")] + [[0, 0]] * 2)  # fmt: skip
    declare(tracker, lasting)
    wires = [key[5:] for key in eye.slots if key.startswith(("scan.number", "scan.age", "scan.returns[1]"))]
    state, book, squares, number, ids = np.array([40.0, 0, *random.normal(0, speed, 2)]), None, [], 0, set()
    for k in range(500):
        for half in range(2):
            for key, value in (("x", state[0] + half * state[2] * T / 2), ("y", state[1] + half * state[3] * T / 2)):
                eye[f"actors[1].{key}"] = value
            eye.step()
            if half == 0:
                is_new, number = eye["scan.number"] != number, eye["scan.number"]
                for key in wires:
                    tracker[f"first.{key}"] = eye[f"scan.{key}"]
                tracker["first.mount"] = mount
                advance(tracker, k)
        if book is not None:
            book.predict(np.zeros(2), 0.0, sigma)
        if is_new and eye["scan.returns[1].valid"]:
            r, a, range_deviation, azimuth_deviation = (
                eye[f"scan.returns[1].{key}"] for key in ("range", "azimuth", "range_deviation", "azimuth_deviation")
            )
            ray = np.array([math.cos(a), math.sin(a)])
            z, sensor = np.array([mount, 0]) + r * ray, np.array([mount, 0])
            J = np.column_stack([ray, r * np.array([-ray[1], ray[0]])])
            R = J @ np.diag([range_deviation**2, azimuth_deviation**2]) @ J.T
            if book is None:
                book = Textbook(z, R, ray, speed, lasting, arm_of(z, sensor, 0))
            else:
                H = np.hstack([np.eye(2), np.zeros((2, 2)), arm_of(book.x[:2], sensor, 0)])
                squares.append(book.correct(z, H, R))
        ids |= {tracker["tracks[1].id"], tracker["tracks[2].id"]}
        truth = state.copy()
        push = random.normal(0, sigma, 2)
        state = np.concatenate([state[:2] + T * state[2:] + T**2 / 2 * push, state[2:] + T * push])
    (last,) = tracks(tracker)
    assert book is not None
    np.testing.assert_allclose([last[key] for key in NAMES], book.x[:4], rtol=0, atol=1e-6)
    P = np.zeros((4, 4))
    P[UPPER] = [last[key] for key in COVARIANCE]
    P += np.triu(P, 1).T
    error = np.array([last[key] for key in NAMES]) - truth
    return squares, error @ np.linalg.solve(P, error), len(ids - {0})


POINT = {"object_camera": {"least_pixels": 0.0}, "object_lidar_roof": {"beam_spacing": 0.0}}  # sees a small box


@pytest.mark.parametrize("runs", [2, pytest.param(100, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("eye", POINT)
def test_innovations_and_errors_are_as_large_as_their_covariances(new_part: NewPart, eye: str, runs: int) -> None:
    """With bias, slow errors and bursts: means of squares within three standard errors of chi-square, plus 2 %.

    Two percent, as the tracker takes bias and slow error for one Gauss-Markov process, and turns range and azimuth into
    places linearly.
    """
    part = new_part(eye, latency=0.0, field_of_view=2 * math.pi, **POINT[eye])
    for key, value in {"class": "car", "length": 0.02, "width": 0.02, "height": 1.5}.items():
        part[f"actors[1].{key}"] = value
    squares, errors = [], []
    for seed in range(runs):
        part["seed"] = seed
        found, error, count = followed(new_part, part, seed, 2.0)
        assert count == 1
        squares += found
        errors.append(error)
    assert np.mean(squares) == pytest.approx(2, abs=3 * 2 / math.sqrt(len(squares)) + 0.04)
    assert np.mean(errors) == pytest.approx(4, abs=3 * math.sqrt(8 / runs) + 0.08)


def test_existence_is_that_of_bayes_from_hits_and_misses(new_part: NewPart) -> None:
    rates = {"birth": 0.3, "detection_rate": 0.8, "false_rate": 0.2}
    part = new_part("kalman_tracker", **QUIET, **rates, confirm=1, of=1)
    odds = 0.3 / 0.7
    for k, hit in enumerate("1101001111111100"):
        see(part, "first", *([(40.0, 2.0)] if hit == "1" else []))
        if k in (3, 9):  # the other sensor: a hit counts, a miss does not
            see(part, "second", *([(40.0, 2.0)] if k == 3 else []))
            odds *= 0.8 / 0.2 if k == 3 else 1
        advance(part, k)
        odds *= 0.8 / 0.2 if hit == "1" else 0.2 / 0.8
        odds = min(odds, 0.999 / 0.001)
        (track,) = tracks(part)
        assert track["existence"] == pytest.approx(odds / (1 + odds), rel=1e-12)


def test_what_no_tracker_passes_on_has_the_covariance_of_its_measurement(new_part: NewPart) -> None:
    """Against 40,000 detections with the errors that the scan declares, within 5 % (three standard errors: 2.1 %)."""
    random, n, age = np.random.default_rng(1), 40_000, 0.3
    part = new_part("no_tracker")
    part["first.scale.deviation"], part["first.misalignment.deviation"], part["first.age"] = 0.03, 0.01, age
    see(part, "first", (40.0, 12.0), range_deviation=0.5, azimuth_deviation=0.01, rate_deviation=0.4, range_rate=1.0)
    part.init()
    part.step()
    (track,) = tracks(part)
    r, a, c = math.hypot(40, 12), math.atan2(12, 40), 40 / math.hypot(40, 12)
    ranges = r + r * random.normal(0, 0.03, n) + random.normal(0, 0.5, n)
    azimuths = a + random.normal(0, 0.01, n) + random.normal(0, 0.01, n)
    speeds = (1 + random.normal(0, 0.4, n)) / c
    errors = np.stack([ranges * np.cos(azimuths) + speeds * age, ranges * np.sin(azimuths), speeds, 0 * speeds])
    P = np.cov(errors)
    sizes = np.sqrt(np.outer(np.diag(P), np.diag(P)))[UPPER]
    assert (np.abs(np.array([track[key] for key in COVARIANCE]) - P[UPPER]) <= 0.05 * sizes).all()
    assert track["existence"] == 1


@pytest.mark.parametrize("pose", [(2.0, 0.9, 0.8), (-2.2, -0.8, -2.6), (-2.3, 0.0, math.pi)])
@pytest.mark.parametrize("name", ["surround_tracker", "kalman_tracker", "no_tracker"])
def test_a_sensor_beside_and_turned_gives_the_place_and_the_speed_that_the_car_measures(
    new_part: NewPart, name: str, pose: tuple[float, float, float]
) -> None:
    """From a yawing car, an object that stands: its range rate is that of the mount, and its place is exact."""
    part, scan = new_part(name), "corner_4" if name == "surround_tracker" else "first"
    (ahead, left, turn), yaw_rate = pose, 0.2
    for key, value in zip(("mount", "mount_left", "mount_turn"), pose, strict=True):
        part[f"{scan}.{key}"] = value
    thing, exact = np.array([-6.0, 9.0]), {"range_deviation": 1e-3, "azimuth_deviation": 1e-5, "rate_deviation": 1e-3}
    place, heading = np.zeros(2), 0.0
    NOISES.setdefault(scan, {})
    for k in range(100):
        drive(part, 15.0, 0.3, yaw_rate)
        if k:
            moved, angle = arc((15.0, 0.3, yaw_rate), (15.0, 0.3, yaw_rate), T)
            place, heading = place + turned(heading) @ moved, heading + angle
        seen = turned(-heading) @ (thing - place)  # from the centre of gravity
        x, y = turned(-turn) @ (seen - np.array([ahead, left]))
        mount_speed = turned(-turn) @ np.array([15.0 - yaw_rate * left, 0.3 + yaw_rate * ahead])
        see(part, scan, (x, y), range_rate=float(-mount_speed @ np.array([x, y]) / math.hypot(x, y)), **exact)
        advance(part, k)
    (track,) = tracks(part)
    assert (track["x"], track["y"]) == pytest.approx(tuple(seen), abs=1e-3)
    if name != "no_tracker":  # which assumes that objects move along the car
        assert (track["vx"], track["vy"]) == pytest.approx((0.0, 0.0), abs=1e-2)


def test_the_tracker_of_seven_sensors_is_that_of_two_where_there_are_two(new_part: NewPart) -> None:
    both = [new_part(name) for name in ("kalman_tracker", "surround_tracker")]
    for k in range(40):
        random = np.random.default_rng(k)
        place = (38.0 + random.normal(0, 0.1), 1.0 + random.normal(0, 0.1))
        for part in both:
            drive(part, 20.0, 0.1, 0.05)
            part["second.scale.deviation"] = 0.01
            see(part, "first", place)
            see(part, "second", (place[0] + 0.2, place[1]))
            advance(part, k)
    assert tracks(both[0]) == tracks(both[1]) != []


def test_a_track_passes_from_a_sensor_that_looks_back_to_one_that_looks_ahead(new_part: NewPart) -> None:
    """A car overtakes on the left by 6 m/s; the rear one sees it to 5 m behind, the front one from 5 m ahead."""
    part = new_part("surround_tracker", **QUIET)
    part["corner_1.mount"], part["corner_1.mount_turn"], part["first.mount"] = -2.2, math.pi, 2.3
    NOISES.setdefault("corner_1", NOISES["first"])
    drive(part, 28.0)
    ids = set()
    for k in range(600):
        x = -40 + 6 * k * T
        if x < -5:
            see(part, "corner_1", (-(x + 2.2), -3.5))
        if x > 5:
            see(part, "first", (x - 2.3, 3.5))
        part["coast"] = 2.0
        advance(part, k)
        ids |= {track["id"] for track in tracks(part)}
    (track,) = tracks(part)
    assert ids == {1}
    assert (track["x"], track["y"], track["vx"]) == pytest.approx((x, 3.5, 34.0), abs=0.3)
