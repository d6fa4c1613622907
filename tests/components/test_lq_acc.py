"""The linear-quadratic cruise control against scipy's Riccati equations, closed forms and figures of ISO 15622."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

NewPart = Callable[..., Any]
Array = NDArray[np.float64]
T, MASS, RADIUS, DRAG_AREA, ROLLING, G = 0.01, 1600.0, 0.31, 0.65, 0.01, 9.81
HEADWAYS = {"fixed": 0.0, "short": 1.0, "middle": 1.5, "long": 2.0}


def road_load(speed: float) -> float:
    return 0.5 * 1.2 * DRAG_AREA * speed**2 / MASS + (ROLLING * G if speed > 0 else 0)


def demanded(part: Any) -> float:
    """The acceleration that its torques give on a level road."""
    torque = part["demand.drive_torque"] - part["demand.brake_torque"]
    return float(torque / RADIUS / MASS) - road_load(part["speed"])


def look(part: Any, speed: float, gap: float, closing: float, detected: bool = True) -> None:
    part["speed"], part["target.gap"], part["target.closing_speed"] = speed, gap, closing
    part["target.detected"] = detected


def held(rates: Array, inputs: Array) -> tuple[Array, Array]:
    """Over one sample with the input held: exponential of the matrix, by scipy."""
    from scipy.linalg import expm

    n = len(rates)
    both = expm(np.block([[rates, inputs], [np.zeros((1, n + 1))]]) * T)
    return both[:n, :n], both[:n, n:]


def gains(rates: Array, inputs: Array, weights: list[float], effort: float) -> Array:
    from scipy.linalg import solve_discrete_are

    a, b = held(rates, inputs)
    cost = solve_discrete_are(a, b, np.diag(weights), [[effort]])
    found: Array = np.linalg.solve(effort + b.T @ cost @ b, b.T @ cost @ a)[0]
    return found


@cache
def following(h: float, gap: float = 4.0, speed: float = 1.0, effort: float = 1.0, lag: float = 0.4) -> Array:
    rates = np.array([[0, 1, -h], [0, 0, -1], [0, 0, -1 / lag]])
    return gains(rates, np.array([[0], [0], [1 / lag]]), [gap**-2, speed**-2, 0], effort**-2)


@cache
def free(speed: float = 1.0, effort: float = 1.0, lag: float = 0.4) -> Array:
    return gains(np.array([[0, 1], [0, -1 / lag]]), np.array([[0], [1 / lag]]), [speed**-2, 0], effort**-2)


@pytest.mark.parametrize("setting", HEADWAYS)
@pytest.mark.parametrize(("gap", "speed", "effort", "lag"), [(4, 1, 1, 0.4), (0.5, 3, 0.3, 1.5), (20, 0.3, 2, 0.06)])
def test_its_gains_are_those_of_the_riccati_equation(
    new_part: NewPart, setting: str, gap: float, speed: float, effort: float, lag: float
) -> None:
    given = {"gap_error": gap, "speed_error": speed, "effort": effort, "lag": lag, "standstill_gap": 0.0}
    limits = {"max_acceleration": 1e9, "max_deceleration": 1e9, "max_jerk": 1e12}
    h, k = HEADWAYS[setting], following(HEADWAYS[setting], gap, speed, effort, lag)
    own, wanted = 20.0, 20.0 * h
    for error, relative in [(-1.0, 0.0), (0.0, -1.0), (-0.3, 0.2)]:
        part = new_part("lq_acc", gap_setting=setting, **given, **limits)
        part["set_speed"], part["set_gap"] = 1e4, 0.0
        look(part, own, wanted + error, -relative)
        part.init()
        first = demanded(part)
        assert first == pytest.approx(-k[0] * error - k[1] * relative, rel=1e-9)
        # In the next sample it reckons with the acceleration that its demand has brought.
        brought = first * -math.expm1(-T / lag)
        way, _ = held(np.array([[0, 1], [0, -1 / lag]]), np.array([[0], [1 / lag]]))[1][:, 0] * first
        look(part, own + way, wanted + h * way + error, -relative)
        part["target.closing_speed"] = own + way - (own + relative)
        part.step()
        expected = -k[0] * error - k[1] * (relative - way) - k[2] * brought
        assert demanded(part) == pytest.approx(expected, rel=1e-9, abs=1e-9)
    part = new_part("lq_acc", **given, **limits)
    look(part, own, 0.0, 0.0, detected=False)
    part["set_speed"] = 21.0
    part.init()
    assert demanded(part) == pytest.approx(free(speed, effort, lag)[0], rel=1e-9)


@dataclass
class Car:
    """A car whose acceleration lags behind the demand, and that something else slows down by *slope* besides."""

    speed: float
    place: float = 0.0
    acceleration: float = 0.0
    lag: float = 0.4
    slope: float = 0.0

    def drive(self, wanted: float) -> None:
        stays = math.exp(-T / self.lag)
        faster = self.lag * (1 - stays)
        by = T - faster
        self.place += self.speed * T + self.acceleration * self.lag * by - self.slope * T**2 / 2
        self.place += wanted * (T**2 / 2 - self.lag * by)
        self.speed += self.acceleration * faster + wanted * by - self.slope * T
        self.acceleration = self.acceleration * stays + wanted * (1 - stays)
        if self.speed <= 0:
            self.speed = 0.0
            self.acceleration = max(self.acceleration, 0.0)


def follow(part: Any, lead: Iterator[float], own: Car, gap: float, set_speed: float = 60.0) -> Array:
    """Rows (time, lead speed, own speed, gap, own acceleration, demand, mode) behind one with these speeds."""
    part["set_speed"] = set_speed
    place, rows = own.place + gap, []
    for k, speed in enumerate(lead):
        look(part, own.speed, place - own.place, own.speed - speed)
        (part.step if k else part.init)()
        rows.append((k * T, speed, own.speed, place - own.place, own.acceleration, demanded(part), part["mode"]))
        own.drive(demanded(part))
        place += speed * T
    return np.array(rows)


def waves(mean: float, swing: float, frequency: float, duration: float) -> Iterator[float]:
    return (mean + swing * math.sin(frequency * k * T) for k in range(round(duration / T)))


def answer(frequency: float, h: float, share: float, lag: float = 0.4, lead_lag: float = 0.5) -> complex:
    """Own speed over the lead's in the frequency domain, sampling left aside."""
    k1, k2, k3 = following(h, lag=lag)
    s = 1j * frequency
    ahead = share * s / (lead_lag * s + 1)
    top = ahead - k1 / s - k2 * (1 - h * ahead) + k3 * ahead
    return complex(top / (s * (lag * s + 1) - k1 / s - k1 * h - k2 + k3 * s))


@pytest.mark.parametrize(("setting", "share"), [("short", 1.0), ("short", 0.0), ("long", 1.0), ("fixed", 1.0)])
@pytest.mark.parametrize("frequency", [0.1, 0.4, 1.0])
def test_a_lead_that_swings_is_followed_as_the_frequency_domain_says(
    new_part: NewPart, setting: str, share: float, frequency: float
) -> None:
    """0.5 m/s about 25 m/s; within 1 %: sampling, and the observer that takes some of it for wind."""
    part = new_part("lq_acc", gap_setting=setting, feed_forward=share, observer_lag=20.0, max_jerk=50.0)
    part["set_gap"] = 30.0
    gap = 30.0 if setting == "fixed" else 4 + 25 * HEADWAYS[setting]
    period = 2 * math.pi / frequency
    swing = min(0.5, 0.8 / frequency)
    rows = follow(part, waves(25.0, swing, frequency, 60.0 + period), Car(25.0), gap)
    last = rows[-round(period / T) :]
    found = 2 * np.mean((last[:, 2] - 25.0) * np.exp(-1j * frequency * last[:, 0])) * 1j / swing
    assert found == pytest.approx(answer(frequency, HEADWAYS[setting], share), abs=0.015)


@pytest.mark.parametrize(
    ("setting", "share", "most"),
    [("short", 1, 1), ("middle", 1, 1), ("long", 1, 1), ("short", 0, 1.0143), ("long", 0, 1), ("fixed", 1, 1.398)],
)
def test_a_platoon_damps_what_its_leader_does_with_time_gaps_only(setting: str, share: float, most: float) -> None:
    """String stability: no frequency is followed with more than its own amplitude; a fixed gap cannot have it."""
    peak = max(abs(answer(w, HEADWAYS[setting], share)) for w in np.logspace(-3, 1.5, 1500))
    assert peak == pytest.approx(most, abs=1e-3)


def test_three_cars_behind_one_that_brakes_swing_less_and_less(new_part: NewPart) -> None:
    speeds: Any = [25.0 - min(max(0.01 * (k - 100), 0.0), 5.0) for k in range(4000)]
    dips = []
    for _ in range(3):
        rows = follow(new_part("lq_acc", gap_setting="short"), iter(speeds), Car(25.0), 29.0)
        speeds = rows[:, 2]
        dips.append(20.0 - rows[:, 2].min())
        assert rows[:, 3].min() > 15
        assert rows[-1, 3] == pytest.approx(24.0, abs=0.05)
    assert max(dips) < 0.05


@pytest.mark.parametrize("slope", [0.5, -0.6])
def test_on_a_hill_no_gap_and_no_speed_is_left_over(new_part: NewPart, slope: float) -> None:
    rows = follow(new_part("lq_acc", gap_setting="middle"), iter([20.0] * 4000), Car(20.0, slope=slope), 34.0)
    assert rows[-1, 3] == pytest.approx(34.0, abs=1e-3)
    rows = follow(new_part("lq_acc"), iter([80.0] * 4000), Car(20.0, slope=slope), 500.0, set_speed=20.0)
    assert rows[-1, 2] == pytest.approx(20.0, abs=1e-4)


def test_behind_a_lead_that_gets_steadily_slower_the_gap_is_the_wanted_one(new_part: NewPart) -> None:
    speeds = [30.0 - max(0.005 * (k - 200), 0.0) for k in range(3000)]
    for share, error in [(1.0, 0.0), (0.0, None)]:
        rows = follow(new_part("lq_acc", gap_setting="short", feed_forward=share), iter(speeds), Car(30.0), 34.0)
        left = rows[-1, 3] - (4 + rows[-1, 2])
        if error is None:  # at rest with w = -h/2, a = u = -1/2: all that K leaves
            k1, k2, k3 = following(1.0)
            assert left == pytest.approx((0.5 * (1 + k3) + 0.5 * k2) / k1, abs=0.02)
            assert abs(left) > 0.5
        else:
            assert left == pytest.approx(error, abs=0.02)


def test_a_small_step_of_the_set_speed_settles_as_the_closed_loop_does(new_part: NewPart) -> None:
    """lag s^2 + (1 + k2) s + k1 = 0 over sampled steps, as matrix powers."""
    part = new_part("lq_acc", max_jerk=50.0, max_acceleration=5.0)
    look(part, 20.0, 0.0, 0.0, detected=False)
    part["set_speed"], car, k = 20.5, Car(20.0), free()
    a, b = held(np.array([[0, 1], [0, -1 / 0.4]]), np.array([[0], [1 / 0.4]]))
    closed, state = a - b @ k[None, :], np.array([-0.5, 0.0])
    for tick in range(800):
        part["speed"] = car.speed
        (part.step if tick else part.init)()
        assert car.speed - 20.5 == pytest.approx(state[0], abs=1e-9)
        car.drive(demanded(part))
        state = closed @ state
    assert abs(state[0]) < 1e-3


def test_limits_hold_and_nothing_winds_up_in_them(new_part: NewPart) -> None:
    part = new_part("lq_acc")
    car = Car(0.0)
    rows = follow(part, iter([90.0] * 2500), car, 1000.0, set_speed=30.0)
    assert rows[:, 5].max() == pytest.approx(2.0, abs=0.02)
    assert rows[:, 2].max() < 30.02
    assert rows[-1, 2] == pytest.approx(30.0, abs=0.01)
    part["set_speed"] = 10.0
    low = math.inf
    for _ in range(1200):
        look(part, car.speed, 0.0, 0.0, detected=False)
        part.step()
        low = min(low, demanded(part))
        car.drive(demanded(part))
    assert low == pytest.approx(-3.5, abs=0.02)
    assert car.speed == pytest.approx(10.0, abs=0.01)


def test_what_it_demands_never_jumps_whoever_comes_and_goes(new_part: NewPart) -> None:
    part = new_part("lq_acc", gap_setting="short")
    part["set_speed"] = 25.0
    car, last, modes = Car(20.0), None, []
    for k in range(3000):
        detected = (k // 400) % 2 == 1
        look(part, car.speed, 15.0 + 10 * ((k // 800) % 2), car.speed - 18.0, detected)
        (part.step if k else part.init)()
        wanted = demanded(part)
        if last is not None:
            assert abs(wanted - last) <= 2.5 * T + 0.005  # the jerk; and what the observer learns in a sample
        last = wanted
        modes.append(part["mode"])
        car.drive(wanted)
    assert {0, 1} == set(modes)


@pytest.mark.parametrize("setting", ["short", "middle", "long"])
def test_it_stops_behind_a_lead_that_brakes_as_iso_15622_has_it(new_part: NewPart, setting: str) -> None:
    """2.5 m/s2 to standstill; its own deceleration within 3.5 m/s2, its jerk within 2.5 m/s3, each over their windows.

    Steadily behind before, the time gap is not below 0.8 s."""
    speed = 30.0
    gap = 4 + HEADWAYS[setting] * speed
    speeds = [max(speed - 2.5 * T * max(k - 3000, 0), 0.0) for k in range(6000)]
    rows = follow(new_part("lq_acc", gap_setting=setting), iter(speeds), Car(speed), gap)
    assert rows[2900:3000, 3].min() / speed >= 0.8
    assert rows[:, 3].min() > 2.0
    assert rows[-1, 2] < 0.1
    assert np.convolve(rows[:, 4], np.ones(200) / 200, "valid").min() >= -3.5
    assert np.abs(rows[100:, 4] - rows[:-100, 4]).max() <= 2.5 + 0.1


@pytest.mark.parametrize(("kmh", "closing"), [(130, 10.0), (90, 12.0), (60, 8.0)])
def test_a_slower_lead_far_ahead_is_caught_up_with_gently(new_part: NewPart, kmh: float, closing: float) -> None:
    own = kmh / 3.6
    rows = follow(
        new_part("lq_acc", gap_setting="middle"), iter([own - closing] * 6000), Car(own), 180.0, set_speed=own
    )
    wanted = 4 + 1.5 * (own - closing)
    assert rows[:, 3].min() > wanted - 1.0
    assert rows[-1, 3] == pytest.approx(wanted, abs=0.1)
    assert rows[:, 4].min() > -3.5
