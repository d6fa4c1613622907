"""The lateral controllers against closed forms, scipy's Riccati equations and a single-track car on a path."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

NewPart = Callable[..., Any]
Array = NDArray[np.float64]
T, G, POINTS = 0.02, 9.81, 24
MASS, INERTIA, LENGTH, SHARE, FRONT, REAR = 1600.0, 2700.0, 2.7, 0.55, 15.0, 18.0  # the controllers' start values
B = SHARE * LENGTH
A = LENGTH - B
CF, CR = FRONT * SHARE * MASS * G, REAR * (1 - SHARE) * MASS * G
UNDERSTEER = MASS * (B / CF - A / CR) / LENGTH
CONTROLLERS = ["pure_pursuit", "lq_preview", "preview_driver", "stanley"]
FREE = {"max_steering": 1.2, "max_steering_rate": 10.0}


@dataclass(frozen=True)
class Road:
    """A path by its curvature: pieces (length, curvature at the start, at the end), banked all along."""

    pieces: tuple[tuple[float, float, float], ...]
    bank: float = 0.0

    def curvature(self, s: float) -> float:
        for length, start, end in self.pieces:
            if s <= length:
                return start + (end - start) * max(s, 0.0) / length
            s -= length
        return self.pieces[-1][2]

    def points(self) -> tuple[Array, Array]:
        return _points(self)

    def at(self, s: float) -> tuple[float, float, float]:
        """Position and heading, by the trapezoidal rule from the table's nearest metre."""
        stations, table = self.points()
        row = min(max(int(s), 0), len(stations) - 1)
        x, y, heading = table[row]
        rest, k0, k1 = s - row, self.curvature(row), self.curvature(s)
        turned = 0.5 * rest * (k0 + k1)
        chord = heading + rest * (2 * k0 + k1) / 6  # mean direction
        shrink = 1 - turned**2 / 24
        return x + rest * shrink * math.cos(chord), y + rest * shrink * math.sin(chord), heading + turned


@cache
def _points(road: Road) -> tuple[Array, Array]:
    """Position and heading at every metre, by Simpson's rule in ten parts."""
    rows, parts = [(0.0, 0.0, 0.0)], 10
    for metre in range(int(sum(piece[0] for piece in road.pieces)) + 200):
        x, y, heading = rows[-1]
        h = 1 / parts
        for n in range(parts):
            s = metre + n * h
            k0, km, k1 = road.curvature(s), road.curvature(s + h / 2), road.curvature(s + h)
            middle, end = heading + h / 4 * (k0 + km), heading + h / 6 * (k0 + 4 * km + k1)
            x += h / 6 * (math.cos(heading) + 4 * math.cos(middle) + math.cos(end))
            y += h / 6 * (math.sin(heading) + 4 * math.sin(middle) + math.sin(end))
            heading = end
        rows.append((x, y, heading))
    return np.arange(len(rows), dtype=float), np.array(rows)


STRAIGHT = Road(((2000.0, 0.0, 0.0),))


def circle(radius: float, bank: float = 0.0) -> Road:
    return Road(((2000.0, 1 / radius, 1 / radius),), bank)


CURVE = Road(
    ((100.0, 0.0, 0.0), (60.0, 0.0, 1 / 120), (80.0, 1 / 120, 1 / 120), (60.0, 1 / 120, 0.0), (60.0, 0.0, 0.0))
)
CORNER = Road(((80.0, 0.0, 0.0), (200.0, 1 / 120, 1 / 120)))


def look(part: Any, road: Road, s: float, offset: float, turn: float, spacing: float = 4.0) -> None:
    """Gives the lane and the preview of a car that stands *offset* to the left and is turned against the path."""
    x, y, heading = road.at(s)
    own = heading + turn
    car_x, car_y = x - offset * math.sin(heading), y + offset * math.cos(heading)
    part["lane.station"], part["lane.offset"], part["lane.heading"] = s, offset, turn
    part["lane.curvature"], part["lane.bank"], part["lane.on_road"] = road.curvature(s), road.bank, True
    for i in range(POINTS):
        px, py, path = road.at(s + (i + 1) * spacing)
        name = f"preview[{i + 1}]"
        part[f"{name}.distance"], part[f"{name}.curvature"] = (i + 1) * spacing, road.curvature(s + (i + 1) * spacing)
        part[f"{name}.x"] = (px - car_x) * math.cos(own) + (py - car_y) * math.sin(own)
        part[f"{name}.y"] = -(px - car_x) * math.sin(own) + (py - car_y) * math.cos(own)
        part[f"{name}.heading"] = path - own


def move(part: Any, speed: float, aside: float, yaw_rate: float) -> None:
    part["motion.speed"], part["motion.lateral_speed"], part["motion.yaw_rate"] = speed, aside, yaw_rate


def drive(
    part: Any,
    road: Road,
    speed: float,
    duration: float,
    start: Sequence[float] = (0.0, 0.0, 0.0, 0.0, 0.0),
    blind: range = range(0),
) -> Array:
    """Rows (time, station, offset, heading error, steering) of a linear-tyred single-track car at constant speed.

    Its exact kinematics along the path (station, offset, heading error), its lateral speed and yaw rate, by classical
    Runge-Kutta steps of 2 ms; *start* has these five. In the samples *blind* it sees what it saw last.
    """

    def rates(z: Array, steering: float) -> Array:
        s, e, t, v, r = z
        along = (speed * math.cos(t) - v * math.sin(t)) / (1 - road.curvature(s) * e)
        front = CF * (steering - (v + A * r) / speed)
        rear = -CR * (v - B * r) / speed
        return np.array(
            [
                along,
                speed * math.sin(t) + v * math.cos(t),
                r - road.curvature(s) * along,
                (front + rear) / MASS - speed * r - G * road.bank,
                (A * front - B * rear) / INERTIA,
            ]
        )

    z, rows, h = np.array(start, dtype=float), [], 0.002
    for k in range(round(duration / T)):
        if k not in blind:
            look(part, road, *z[:3])
        move(part, speed, *z[3:])
        if k == 0:
            part.init()
        part.step()
        steering = part["steering"]
        rows.append((k * T, *z[:3], steering))
        for _ in range(round(T / h)):
            k1 = rates(z, steering)
            k2 = rates(z + h / 2 * k1, steering)
            k3 = rates(z + h / 2 * k2, steering)
            z = z + h / 6 * (k1 + 2 * k2 + 2 * k3 + rates(z + h * k3, steering))
    return np.array(rows)


def balance(speed: float, curvature: float, bank: float = 0.0) -> tuple[float, float]:
    """Heading error and steering of the car on a circle, linear."""
    sideways = speed**2 * curvature + G * bank
    return -B * curvature + MASS * A * sideways / (LENGTH * CR), LENGTH * curvature + UNDERSTEER * sideways


def model(speed: float) -> tuple[Array, Array]:
    """Transition and steering column of (offset, its rate, heading error, its rate) over one sample."""
    from scipy.linalg import expm

    rates = np.zeros((5, 5))
    rates[0, 1] = rates[2, 3] = 1
    turning, damping = A * CF - B * CR, A**2 * CF + B**2 * CR
    rates[1] = [0, -(CF + CR) / (MASS * speed), (CF + CR) / MASS, -turning / (MASS * speed), CF / MASS]
    rates[3] = [0, -turning / (INERTIA * speed), turning / INERTIA, -damping / (INERTIA * speed), A * CF / INERTIA]
    over = expm(rates * T)
    return over[:4, :4], over[:4, 4:]


def answer(part: Any, speed: float, state: Iterable[float]) -> float:
    """What the controller wants first on a straight road, for (offset, its rate, heading error, its rate)."""
    offset, rate, turn, yaw_rate = state
    look(part, STRAIGHT, 500.0, offset, turn)
    move(part, speed, (rate - speed * math.sin(turn)) / math.cos(turn), yaw_rate)
    part.init()
    return float(part["steering"])


def gains(part: Any, speed: float) -> Array:
    """K of steering = -K z, from answers to small deviations."""
    small = 1e-5
    answers = [[answer(part, speed, sign * small * row) for row in np.eye(4)] for sign in (1, -1)]
    difference: Array = np.array(answers[0]) - np.array(answers[1])
    return -difference / (2 * small)


# LQ with preview


@pytest.mark.parametrize(("offset", "heading", "effort"), [(0.3, 3.0, 3.0), (0.05, 10.0, 1.0), (3.0, 0.5, 20.0)])
def test_lq_gains_are_those_of_scipys_riccati_equation(
    new_part: NewPart, offset: float, heading: float, effort: float
) -> None:
    from scipy.linalg import solve_discrete_are

    heading, effort = math.radians(heading), math.radians(effort)
    part = new_part("lq_preview", offset_error=offset, heading_error=heading, steering_effort=effort, **FREE)
    weights, price = np.diag([offset**-2, 0, heading**-2, 0]), np.array([[effort**-2]])
    for speed in 2.5 * np.arange(1, 25):
        transition, steering = model(speed)
        cost = solve_discrete_are(transition, steering, weights, price)
        expected = np.linalg.solve(price + steering.T @ cost @ steering, steering.T @ cost @ transition)[0]
        # Answers to unit deviations of a linear law: the heading error alone, so that no sine comes between.
        found = [-answer(part, speed, row) for row in np.eye(4) * [1e-2, 1e-2, 0, 1e-2]]
        look(part, STRAIGHT, 500.0, 0.0, 0.0)
        move(part, speed, 0.0, 0.0)
        part["lane.heading"], part["motion.lateral_speed"] = 1e-2, -speed * math.tan(1e-2)
        part.init()
        found[2] = -part["steering"]
        assert np.array(found) / 1e-2 == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_lq_preview_gains_are_those_of_the_riccati_equation_with_the_road_in_its_state(new_part: NewPart) -> None:
    """Sharp and Valtetsiotis: a shift register of coming changes of the curvature is part of the plant."""
    from scipy.linalg import solve_discrete_are

    speed, count, spacing = 20.0, 20, 0.4
    part = new_part("lq_preview", preview_time=count * T, **FREE)
    transition, steering = model(speed)
    register = np.eye(count, k=1)
    disturbed = np.zeros((4, count))
    disturbed[2, 0] = -balance(speed, 1.0)[0]
    plant = np.block([[transition, disturbed], [np.zeros((count, 4)), register]])
    acts = np.vstack([steering, np.zeros((count, 1))])
    weights = np.zeros((4 + count, 4 + count))
    weights[0, 0], weights[2, 2] = 0.3**-2, math.radians(3) ** -2
    price = np.array([[math.radians(3) ** -2]])
    cost = solve_discrete_are(plant, acts, weights, price)
    expected = np.linalg.solve(price + acts.T @ cost @ acts, acts.T @ cost @ plant)[0, 4:]
    found = []
    for ahead in range(1, count + 1):
        look(part, STRAIGHT, 500.0, 0.0, 0.0, spacing)
        move(part, speed, 0.0, 0.0)
        for i in range(ahead - 1, POINTS):
            part[f"preview[{i + 1}].curvature"] = 1e-3
        part.init()
        found.append(-part["steering"] / 1e-3)
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("bank", [0.0, -0.05])
def test_lq_holds_the_middle_of_a_banked_circle_with_the_steering_of_the_closed_form(
    new_part: NewPart, bank: float
) -> None:
    rows = drive(new_part("lq_preview"), circle(400.0, bank), 20.0, 12.0)
    *_, offset, turn, steering = rows[-1]
    heading, expected = balance(20.0, 1 / 400, bank)
    # The closed form is linear in the angles: what is left is their squares, and 1 - k e.
    assert offset == pytest.approx(0.0, abs=2e-3)
    assert steering == pytest.approx(expected, rel=2e-3)
    assert turn == pytest.approx(heading, abs=2e-5)


@pytest.mark.thorough
def test_the_further_the_preview_the_less_what_the_lq_law_minimises(new_part: NewPart) -> None:
    speed, heading, effort = 70 / 3.6, math.radians(3), math.radians(3)
    costs = []
    for seconds in (0.0, 0.2, 0.5, 1.5):
        rows = drive(new_part("lq_preview", preview_time=seconds), CORNER, speed, 9.0)
        turn, steering = np.array([balance(speed, CORNER.curvature(s)) for s in rows[:, 1]]).T
        deviations = rows[:, 2] / 0.3, (rows[:, 3] - turn) / heading, (rows[:, 4] - steering) / effort
        costs.append(sum(np.square(deviation).sum() for deviation in deviations))
    assert costs[0] > 1.2 * costs[-1]
    assert all(first > second for first, second in pairwise(costs)), costs


# Pure pursuit


@pytest.mark.parametrize("radius", [15.0, -40.0, 300.0])
@pytest.mark.parametrize("speed", [0.0, 12.0])
def test_pure_pursuit_steers_along_the_circle_it_is_on(new_part: NewPart, radius: float, speed: float) -> None:
    # On the circle with its rear axle: the centre of gravity is ahead of it, outside and turned.
    road, turn = circle(radius), -math.atan(B / radius)
    part = new_part("pure_pursuit", **FREE)
    look(part, road, 100.0, radius - math.copysign(math.hypot(radius, B), radius), turn, 1.0)
    move(part, speed, 0.0, 0.0)
    part.init()
    # Between the preview's points are cubics.
    assert part["steering"] == pytest.approx(math.atan(LENGTH / radius), rel=1e-5)


def test_pure_pursuit_is_outside_of_the_circle_by_what_the_tyres_give_way(new_part: NewPart) -> None:
    speed, radius, ahead = 25.0, 800.0, 20.0
    rows = drive(new_part("pure_pursuit", lookahead_time=ahead / speed), circle(radius), speed, 20.0)
    *_, offset, turn, steering = rows[-1]
    heading, expected = balance(speed, 1 / radius)
    slip = MASS * A * speed**2 / radius / (LENGTH * CR)  # of the rear axle
    rear = -(UNDERSTEER * speed**2 / radius * ahead / (2 * LENGTH) + slip) * ahead
    # The rear axle's offset, from where the centre of gravity is B ahead, at B turned by its own slip.
    assert offset + B * (-heading - B / 2 / radius) == pytest.approx(rear, rel=0.02)
    assert steering == pytest.approx(expected, rel=2e-3)
    assert turn == pytest.approx(heading, abs=1e-4)


def test_the_look_ahead_grows_with_the_speed_between_its_bounds(new_part: NewPart) -> None:
    part = new_part("pure_pursuit", lookahead_time=1.0, min_lookahead=5.0, max_lookahead=30.0, **FREE)
    for speed, ahead in [(0.0, 5.0), (4.0, 5.0), (12.0, 12.0), (29.0, 29.0), (50.0, 30.0)]:
        offset = 0.5
        look(part, STRAIGHT, 100.0, offset, 0.0)
        move(part, speed, 0.0, 0.0)
        part.init()
        assert part["steering"] == pytest.approx(-math.atan(2 * LENGTH * offset / ahead**2), rel=1e-9)


# Stanley


@pytest.mark.parametrize("radius", [15.0, -40.0, 300.0])
def test_stanley_at_rest_turns_the_front_wheels_along_the_circle_that_the_front_axle_is_on(
    new_part: NewPart, radius: float
) -> None:
    rear = math.copysign(math.sqrt(radius**2 - LENGTH**2), radius)  # of the rear axle's circle
    part = new_part("stanley", **FREE)
    centre = math.copysign(math.hypot(rear, B), radius)
    look(part, circle(radius), 100.0, radius - centre, -math.atan(B / rear), 1.0)
    move(part, 0.0, 0.0, 0.0)
    part.init()
    assert part["steering"] == pytest.approx(math.asin(LENGTH / radius), rel=1e-4)  # cubics between the points


@pytest.mark.parametrize("spacing", [0.3, 4.0])
def test_stanleys_law_on_a_straight_road_is_that_of_the_paper(new_part: NewPart, spacing: float) -> None:
    gain, softening, damping, speed, yaw_rate = 1.7, 0.8, 0.13, 14.0, 0.07
    part = new_part("stanley", gain=gain, softening=softening, yaw_damping=damping, **FREE)
    for offset, turn in [(0.6, 0.1), (-1.5, 0.2), (4.0, -0.4), (-0.2, 0.0)]:
        look(part, STRAIGHT, 100.0, offset, turn, spacing)
        move(part, speed, 0.3, yaw_rate)
        part.init()
        front = offset + A * math.sin(turn)
        expected = -turn - math.atan(gain * front / (softening + speed)) - damping * yaw_rate
        assert part["steering"] == pytest.approx(expected, rel=1e-9)


def test_stanley_without_a_preview_goes_straight_on_from_where_the_car_is_beside_the_path(new_part: NewPart) -> None:
    part = new_part("stanley", **FREE)
    look(part, STRAIGHT, 100.0, 0.7, 0.1)
    move(part, 9.0, 0.0, 0.0)
    part.init()
    seen = part["steering"]
    for point in range(POINTS):
        part[f"preview[{point + 1}].distance"] = 0.0
    part.init()
    assert part["steering"] == pytest.approx(seen, rel=1e-9)


def test_the_front_axle_comes_back_as_the_papers_differential_equation_says(new_part: NewPart) -> None:
    """Front wheels that do not slip: e' = -v gain e / sqrt((softening + v)^2 + gain^2 e^2), and its first integral."""
    gain, soft, speed = 2.0, 1.5, 6.0
    part = new_part("stanley", gain=gain, softening=soft, yaw_damping=0.0, **FREE)
    front, turn, s, h, rows = 1.5, 0.0, 100.0, 0.001, []
    for k in range(150):
        look(part, STRAIGHT, s - A * math.cos(turn), front - A * math.sin(turn), turn)
        move(part, speed, 0.0, 0.0)
        part.init()
        rows.append((k * T, front))
        for _ in range(round(T / h)):
            steering = part["steering"]
            front += h * speed * math.sin(turn + steering)
            s += h * speed * math.cos(turn + steering)
            turn += h * speed * math.sin(steering) / LENGTH

    def first_integral(e: float) -> float:
        c, root = soft + speed, math.hypot(soft + speed, gain * e)
        return root - c * math.log((c + root) / (gain * e))

    for time, e in rows[10::20]:
        # Steering that is held for a sample while the car turns: T/2 of 1/gain.
        assert (first_integral(1.5) - first_integral(e)) / (speed * gain) == pytest.approx(time, rel=0.03, abs=T)
    assert rows[-1][1] < 0.02


@pytest.mark.parametrize("bank", [0.0, -0.05])
def test_stanley_holds_the_front_axle_on_a_banked_circle(new_part: NewPart, bank: float) -> None:
    radius, speed = 400.0, 20.0
    rows = drive(new_part("stanley"), circle(radius, bank), speed, 12.0)
    *_, offset, turn, steering = rows[-1]
    heading, expected = balance(speed, 1 / radius, bank)
    assert offset + A * turn - A**2 / (2 * radius) == pytest.approx(0.0, abs=2e-3)
    assert steering == pytest.approx(expected, rel=2e-3)
    assert turn == pytest.approx(heading, abs=1e-4)


# The driver


def test_the_driver_answers_a_reaction_time_late_and_as_the_lag_of_his_arms(new_part: NewPart) -> None:
    reaction, muscle = 0.25, 0.12
    part = new_part("preview_driver", reaction_time=reaction, muscle_time=muscle, **FREE)
    look(part, STRAIGHT, 100.0, 0.0, 0.0)
    move(part, 20.0, 0.0, 0.0)
    part.init()
    for _ in range(20):
        part.step()
    assert part["steering"] == 0
    look(part, STRAIGHT, 100.0, -0.1, 0.0)
    found = []
    for _ in range(60):
        part.step()
        found.append(part["steering"])
    part.init()
    wanted = part["steering"]
    times = T * np.arange(60)
    # Seen at the first sample; half of it arrives between two of them, so the ramp between is held for one.
    late = np.array([np.clip((t - reaction) / T + 1, 0, 1) for t in times])
    expected, value = [], 0.0
    for command in late * wanted:
        value += (1 - math.exp(-T / muscle)) * (command - value)
        expected.append(value)
    assert wanted > 0
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-15)
    assert np.count_nonzero(found) == np.count_nonzero(times > reaction - T)


def test_the_driver_wants_what_a_least_squares_fit_of_his_prediction_wants(new_part: NewPart) -> None:
    speed, preview = 17.5, 1.2
    part = new_part("preview_driver", preview_time=preview, **FREE)
    road, aside, yaw_rate = circle(200.0), 0.12, 0.03
    look(part, road, 50.0, 0.4, -0.02)
    move(part, speed, aside, yaw_rate)
    part.init()
    transition, steering = model(speed)
    z, unit = np.array([0, aside, 0, yaw_rate]), np.zeros(4)
    straight, by_steering = [], []
    for _ in range(60):
        z, unit = transition @ z, transition @ unit + steering[:, 0]
        straight.append(z[0])
        by_steering.append(unit[0])
    at = np.arange(6, 61, 6) - 1  # ten glances, every 120 ms
    x, y, heading = road.at(50.0)
    car = np.array([x, y]) + 0.4 * np.array([-math.sin(heading), math.cos(heading)])
    left = np.array([-math.sin(heading - 0.02), math.cos(heading - 0.02)])
    path = np.array([(np.array(road.at(50.0 + speed * T * (n + 1))[:2]) - car) @ left for n in at])
    expected = np.linalg.lstsq(np.array(by_steering)[at, None], path - np.array(straight)[at], rcond=None)[0][0]
    assert part["steering"] == pytest.approx(expected, rel=1e-6)  # cubics between the preview's points


def test_a_driver_with_slower_reactions_swings_more(new_part: NewPart) -> None:
    start = (0.0, 1.0, 0.0, 0.0, 0.0)
    quick, slow = (
        drive(new_part("preview_driver", reaction_time=seconds), STRAIGHT, 25.0, 12.0, start)[:, 2]
        for seconds in (0.1, 0.4)
    )
    assert -slow.min() > 2 * max(-quick.min(), 0)
    assert -slow.min() > 0.05


# All


@pytest.mark.parametrize(
    ("name", "worst"), [("pure_pursuit", 0.5), ("lq_preview", 0.005), ("preview_driver", 0.06), ("stanley", 0.1)]
)
def test_a_spiral_into_120_m_radius_at_70_km_h_is_followed(new_part: NewPart, name: str, worst: float) -> None:
    rows = drive(new_part(name), CURVE, 70 / 3.6, 18.0)
    assert rows[-1, 1] > 340  # all of the curve
    assert abs(rows[:, 2]).max() < worst
    assert abs(rows[-1, 2]) < 0.02
    assert 0.02 < rows[:, 4].max() < 0.06  # 0.029 rad on the circle by the closed form


@pytest.mark.parametrize("name", CONTROLLERS)
def test_the_loop_is_stable_from_walking_pace_to_200_km_h(new_part: NewPart, name: str) -> None:
    part = new_part(name, **FREE)
    for speed in (1.0, 2.0, 3.7, 6.0, 10.0, 15.0, 21.3, 28.0, 36.0, 45.0, 56.0):
        transition, steering = model(speed)
        gain = gains(part, speed)
        if name == "preview_driver":
            late = round(part["reaction_time"] / T)  # rows of memory between the wish and the arms
            follows = 1 - math.exp(-T / part["muscle_time"])
            size = 4 + late + 1
            loop = np.zeros((size, size))  # state: z, wishes from the newest to the oldest, steering before
            loop[-1, -1], loop[-1, -2] = 1 - follows, follows
            loop[5:-1, 4:-2] = np.eye(late - 1)
            loop[4, :4] = -gain
            loop[:4, :4] = transition
            loop[:4] += steering @ loop[-1:]
        else:
            loop = transition - steering @ gain[None]
        radius = abs(np.linalg.eigvals(loop)).max()
        assert radius < 1 - 0.1 * T, f"{speed} m/s: slower than 10 s, or unstable: {radius}"


@pytest.mark.parametrize("name", CONTROLLERS)
def test_left_is_the_mirror_of_right(new_part: NewPart, name: str) -> None:
    steered = []
    for side in (1, -1):
        part = new_part(name)
        look(part, circle(side * 150.0, side * -0.03), 30.0, side * 0.3, side * 0.02)
        move(part, 16.3, side * -0.2, side * 0.11)
        part.init()
        part.step()
        steered.append(part["steering"])
    assert steered[0] == pytest.approx(-steered[1], rel=1e-12)
    assert steered[0] != 0


@pytest.mark.parametrize("name", CONTROLLERS)
def test_steering_keeps_to_its_limit_and_its_rate(new_part: NewPart, name: str) -> None:
    part = new_part(name, max_steering=0.1, max_steering_rate=0.5)
    look(part, STRAIGHT, 100.0, 0.0, 0.0)
    move(part, 15.0, 0.0, 0.0)
    part.init()
    look(part, STRAIGHT, 100.0, -15.0, 0.0)
    found = [0.0]
    for _ in range(100):
        part.step()
        found.append(part["steering"])
    assert max(np.diff(found)) == pytest.approx(0.5 * T, rel=1e-9)
    assert found[-1] == pytest.approx(0.1, rel=1e-3)  # the driver's arms come near, never there
    assert max(found) <= 0.1


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_lane_that_is_lost_for_a_while_is_held_and_found_again(new_part: NewPart, name: str) -> None:
    """0.3 s without a look on the way into a bend of 120 m radius, at 15 m/s."""
    lost = range(450, 465)
    seen, held = (drive(new_part(name), CURVE, 15.0, 16.0, blind=blind) for blind in (range(0), lost))
    worse = np.abs(held[:, 2] - seen[:, 2])
    assert worse[: lost.start + 1].max() == 0
    assert worse.max() < 0.25
    assert worse[-1] < 0.02
    assert np.abs(held[:, 2]).max() < 0.6
