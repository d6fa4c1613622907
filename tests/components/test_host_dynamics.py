"""The host on its wheels against scipy's solution of the same equations, and against closed forms."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

NewPart = Callable[..., Any]
Torques = tuple[float, float, float, float]  # drive front, drive rear, brake front, brake rear
MASS, RADIUS, INERTIA, DRAG_AREA, DENSITY, ROLLING = 1600.0, 0.31, 2.0, 0.65, 1.2, 0.01
SHARE, CG_HEIGHT, WHEELBASE, STIFFNESS = 0.55, 0.55, 2.7, 20.0
G = 9.81


def saturate(x: float) -> float:
    return x / math.sqrt(1 + x * x)


def right_side(y: NDArray[np.float64], torques: Torques, friction: float, slope: float) -> list[float]:
    """Time derivatives of position, speed and both spins, as host.h writes them, the loads found by iteration."""
    _, v, *spins = y
    cosine = math.cos(math.atan(slope))
    grip = [friction * saturate(STIFFNESS / friction * (RADIUS * w - v) / math.sqrt(v * v + 0.05**2)) for w in spins]
    loads = [SHARE * MASS * G * cosine, (1 - SHARE) * MASS * G * cosine]
    total = 0.0
    for _ in range(60):  # the moment balance, a contraction because the centre of gravity is low
        total = grip[0] * (loads[0] - total * CG_HEIGHT / WHEELBASE) + grip[1] * (
            loads[1] + total * CG_HEIGHT / WHEELBASE
        )
    loads = [loads[0] - total * CG_HEIGHT / WHEELBASE, loads[1] + total * CG_HEIGHT / WHEELBASE]
    drag = 0.5 * DENSITY * DRAG_AREA * v * abs(v)
    spin_rates = [
        (drive - (brake + ROLLING * RADIUS * load) * saturate(w / 0.001) - RADIUS * mu * load) / INERTIA
        for drive, brake, load, w, mu in zip(torques[:2], torques[2:], loads, spins, grip, strict=True)
    ]
    return [v, (total - drag - MASS * G * math.sin(math.atan(slope))) / MASS, *spin_rates]


def solve(start: float, course: Sequence[tuple[float, Torques]], friction: float, slope: float) -> NDArray[np.float64]:
    """States at the end of every piece of the course, to about ten digits."""
    from scipy.integrate import solve_ivp

    def rates(torques: Torques, _: float, y: NDArray[np.float64]) -> list[float]:
        return right_side(y, torques, friction, slope)

    y = np.array([0.0, start, start / RADIUS, start / RADIUS])
    rows = []
    for duration, torques in course:
        solution = solve_ivp(
            partial(rates, torques),
            (0, duration),
            y,
            method="Radau",
            rtol=1e-10,
            atol=1e-11,
        )
        y = solution.y[:, -1]
        rows.append(y)
    return np.array(rows)


def act(part: Any, torques: Torques) -> None:
    for port, torque in zip(("wheels.front", "wheels.rear", "brake.front", "brake.rear"), torques, strict=True):
        part[port] = torque


def state(part: Any) -> list[float]:
    return [part["position"], part["speed"], part["wheel_speed.front"], part["wheel_speed.rear"]]


def drive(part: Any, course: Sequence[tuple[float, Torques]]) -> NDArray[np.float64]:
    part.init()
    rows = []
    for duration, torques in course:
        act(part, torques)
        for _ in range(round(duration / 0.01)):
            part.step()
        rows.append(state(part))
    return np.array(rows)


STANDING_START: list[tuple[float, Torques]] = [
    (0.5, (300.0, 0.0, 0.0, 0.0)),
    (1.0, (1100.0, 200.0, 0.0, 0.0)),
    (1.0, (700.0, 0.0, 0.0, 0.0)),
]
BRAKING: list[tuple[float, Torques]] = [
    (0.5, (0.0, 0.0, 0.0, 0.0)),
    (0.7, (0.0, 0.0, 900.0, 500.0)),
    (0.8, (0.0, 0.0, 2200.0, 1200.0)),
    (0.5, (400.0, 400.0, 0.0, 0.0)),
]


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("start", "course", "friction", "slope"),
    [(0.0, STANDING_START, 0.9, 0.0), (0.0, STANDING_START, 0.9, 0.06), (22.0, BRAKING, 0.6, -0.04)],
)
def test_the_host_equals_scipys_solution_to_1e_6_at_a_fine_step(
    new_part: NewPart, start: float, course: list[tuple[float, Torques]], friction: float, slope: float
) -> None:
    part = new_part("straight_road", initial_speed=start, friction=friction, grade=slope, substeps=100)
    assert drive(part, course) == pytest.approx(solve(start, course, friction, slope), rel=1e-6)


def test_one_substep_of_10_ms_is_within_a_millimetre_of_the_solution(new_part: NewPart) -> None:
    part = new_part("straight_road")
    assert part["substeps"] == 1
    assert abs(drive(part, STANDING_START) - solve(0.0, STANDING_START, 0.9, 0.0))[:, :2].max() < 1e-3


def test_the_integrator_converges_with_second_order(new_part: NewPart) -> None:
    exact = solve(22.0, BRAKING, 0.9, 0.0)[-1]
    errors = []
    for substeps in (8, 16, 32):
        part = new_part("straight_road", initial_speed=22.0, substeps=substeps)
        errors.append(abs(drive(part, BRAKING)[-1] - exact))
    for coarse, fine in pairwise(errors):
        assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.1)


def test_the_acceleration_is_the_derivative_of_the_speed(new_part: NewPart) -> None:
    part = new_part("straight_road", initial_speed=15.0, substeps=4)
    part.init()
    assert part["acceleration"] == pytest.approx(
        right_side(np.array([0, 15, 15 / RADIUS, 15 / RADIUS]), (0,) * 4, 0.9, 0)[1]
    )
    act(part, (500.0, 0.0, 0.0, 0.0))
    for _ in range(200):
        part.step()
    derivatives = right_side(np.array(state(part)), (500.0, 0.0, 0.0, 0.0), 0.9, 0.0)
    assert part["acceleration"] == pytest.approx(derivatives[1], rel=1e-9)


@pytest.mark.parametrize("slope", [0.0, 0.03, -0.02])
def test_the_top_speed_is_where_the_forces_balance(new_part: NewPart, slope: float) -> None:
    # Per travel the wheel turns further than the car by its slip, but the torque balance holds per angle.
    part = new_part("straight_road", initial_speed=38.0, grade=slope)
    part.init()
    torque = 350.0
    act(part, (torque, 0.0, 0.0, 0.0))
    for _ in range(20_000):
        part.step(0.1)
    cosine = 1 / math.sqrt(1 + slope * slope)
    push = torque / RADIUS - ROLLING * MASS * G * cosine - MASS * G * slope * cosine
    # Rolling resistance is full to within (1 mrad/s / spin)^2 / 2, which is 1e-9 here.
    assert part["speed"] == pytest.approx(math.sqrt(push / (0.5 * DENSITY * DRAG_AREA)), rel=1e-8)
    assert part["acceleration"] == pytest.approx(0.0, abs=1e-9)


def test_a_car_without_torque_stays_where_it_is(new_part: NewPart) -> None:
    part = new_part("straight_road")
    part.init()
    for _ in range(500):
        part.step()
    assert state(part) == [0, 0, 0, 0]


@pytest.mark.parametrize("slope", [0.1, -0.1])
@pytest.mark.parametrize("substeps", [1, 10])
def test_brakes_hold_the_car_on_a_slope(new_part: NewPart, slope: float, substeps: int) -> None:
    part = new_part("straight_road", grade=slope, substeps=substeps)
    part.init()
    act(part, (0.0, 0.0, 1500.0, 800.0))
    for _ in range(1000):
        part.step()
        assert abs(part["speed"]) < 1e-3
    # The holding torque is smooth at zero, so the car creeps; ten seconds move it by less than 5 mm.
    assert abs(part["position"]) < 5e-3
    assert abs(part["acceleration"]) < 1e-9


@pytest.mark.parametrize("brake", [(600.0, 300.0), (2500.0, 1300.0), (20_000.0, 20_000.0)])
@pytest.mark.parametrize("substeps", [1, 4])
def test_a_car_is_braked_to_standstill_without_chatter(
    new_part: NewPart, brake: tuple[float, float], substeps: int
) -> None:
    part = new_part("straight_road", initial_speed=8.0, substeps=substeps)
    part.init()
    act(part, (0.0, 0.0, *brake))
    speeds = []
    for _ in range(1000):
        part.step()
        speeds.append(part["speed"])
    # Falling all the way; the tread springs back by less than a millimetre per second when it stops.
    assert min(speeds) > -1e-3
    assert max(np.diff(speeds)) < 1e-3
    assert abs(speeds[-1]) < 1e-9
    assert abs(part["wheel_speed.front"]) < 1e-9


@pytest.mark.parametrize("friction", [0.3, 0.9])
def test_locked_wheels_brake_with_friction_times_gravity(new_part: NewPart, friction: float) -> None:
    part = new_part("straight_road", initial_speed=30.0, friction=friction, drag_area=0.0)
    part.init()
    act(part, (0.0, 0.0, 20_000.0, 20_000.0))
    for _ in range(50):
        part.step()
    # The smooth tyre reaches its friction to within (friction / stiffness)^2 / 2 at full slip.
    assert part["acceleration"] == pytest.approx(-friction * G, rel=0.6 * (friction / STIFFNESS) ** 2 + 1e-4)
    assert abs(part["wheel_speed.front"]) < 0.01
    assert abs(part["wheel_speed.rear"]) < 0.01
    before, travelled = part["speed"], part["position"]
    while part["speed"] > 1.0:
        part.step()
    distance = (before**2 - part["speed"] ** 2) / (2 * friction * G)
    assert part["position"] - travelled == pytest.approx(distance, rel=0.005)


def test_braking_loads_the_front_axle_as_the_moment_balance_says(new_part: NewPart) -> None:
    # With the front wheels locked and the rear rolling, the force is mu times the loaded front axle.
    part = new_part("straight_road", initial_speed=30.0, drag_area=0.0, rolling_resistance=0.0)
    part.init()
    act(part, (0.0, 0.0, 20_000.0, 0.0))
    for _ in range(50):
        part.step()
    # X = -mu (W_front - X h/L), so X = -mu W_front / (1 - mu h/L). The rear wheels' inertia takes a little more.
    force = 0.9 * SHARE * MASS * G / (1 - 0.9 * CG_HEIGHT / WHEELBASE)
    assert -part["acceleration"] * (MASS + INERTIA / RADIUS**2) == pytest.approx(force, rel=0.012)


def test_wheels_spin_when_torque_exceeds_the_grip(new_part: NewPart) -> None:
    part = new_part("straight_road", friction=0.3)
    part.init()
    act(part, (3000.0, 0.0, 0.0, 0.0))
    for _ in range(100):
        part.step()
    assert RADIUS * part["wheel_speed.front"] > 5 * part["speed"]
    # X = mu (W_front - X h/L) pushes, less the drag of the rear axle's rolling resistance.
    force = 0.3 * SHARE * MASS * G / (1 + 0.3 * CG_HEIGHT / WHEELBASE)
    assert 0.95 * force < part["acceleration"] * MASS < force
