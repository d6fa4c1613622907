"""Differentials and half shafts against closed forms and scipy."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from bench import Bench, Rows, opened
from scipy.integrate import solve_ivp
from scipy.linalg import expm

ENGINE, RATIO, STIFFNESS, DAMPING = 0.2, 15.0, 30e3, 150.0
SIDE, PRELOAD, LOCKING, LAG = 0.02, 80.0, 0.35, 5e-3
INPUTS = ("torque", "load_left", "load_right")


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Path:
    return built_before(tmp_path_factory.mktemp("axle"))


def driven(model: str, names: tuple[str, ...], phases: list[tuple[float, ...]], inertia: float, cache: Path) -> Rows:
    """Values of *names* every 5 ms; each phase has a duration and the values of `INPUTS`."""
    bench = Bench(opened(f"Axle.{model}", cache), 1e-9, {"wheel_inertia": inertia})
    rows, now = [], 0.0
    for duration, *values in phases:
        bench.set(dict(zip(INPUTS, values, strict=True)))
        for _ in range(round(duration / 5e-3)):
            bench.step(now, 5e-3)
            now += 5e-3
            rows.append([now, *bench.get(names)])
    bench.close()
    return np.array(rows)


@pytest.mark.thorough
def test_an_engine_in_first_gear_and_a_car_shuffle_as_two_inertias(cache: Path) -> None:
    """Both half shafts as one of twice the stiffness: w0^2 = k*(1/J1 + 1/J2), and w = w0*(1 - z^2)^0.5 damped."""
    car = 77.0  # of each wheel: half of 1600 kg at 0.31 m
    found = driven("Open", ("engine.speed", "left_speed"), [(1.5, 20.0, 50.0, 50.0)], car, cache)
    rate = 1 / (ENGINE * RATIO**2) + 1 / (2 * car)
    free = math.sqrt(2 * STIFFNESS * rate)
    damped = free * math.sqrt(1 - (DAMPING * rate / free) ** 2)
    assert 4.0 < damped / (2 * math.pi) < 8.0
    wave = found[:, 1] / RATIO - found[:, 2]
    up = np.flatnonzero((wave[:-1] > 0) != (wave[1:] > 0))
    crossings = found[up, 0] + 5e-3 * wave[up] / (wave[up] - wave[up + 1])
    # A sine is a straight line near its zero to (w*h)^2/24 of a sample.
    assert np.diff(crossings[:12]) == pytest.approx(math.pi / damped, rel=2e-3)


@pytest.mark.thorough
def test_an_open_differential_gives_both_wheels_the_same_torque_as_the_matrix_exponential_says(cache: Path) -> None:
    """The engine and one twist per side swing; wheels without load run away from those with load."""
    torque, left, right = 20.0, 250.0, 50.0
    names = ("engine.speed", "left_speed", "right_speed", "difference", "work", "loss", "energy")
    found = driven("Open", names, [(1.0, torque, left, right)], 1.0, cache)
    # Bevel gears without mass: both shafts' torques are equal, so that the sum of the twists is a state, and their
    # difference never becomes one.
    system = np.zeros((5, 5))  # speeds of engine and wheels, twist of one shaft (mean), 1
    slip = np.array([1 / RATIO, -0.5, -0.5, 0.0, 0.0])
    shaft = DAMPING * slip + np.array([0.0, 0.0, 0.0, STIFFNESS, 0.0])
    system[0] = -2 * shaft / RATIO / ENGINE
    system[1], system[2], system[3] = shaft, shaft, slip
    system[0, 4], system[1, 4], system[2, 4] = torque / ENGINE, -left, -right
    expected = np.array([expm(system * t) @ np.array([0.0, 0.0, 0.0, 0.0, 1.0]) for t in found[:, 0]])
    scale = np.abs(expected[:, :3]).max()
    assert np.abs(found[:, 1:4] - expected[:, :3]).max() < 1e-6 * scale
    assert np.abs(found[:, 4]).max() < 1e-6
    assert found[-1, 3] > 100 + found[-1, 2]
    assert np.abs(found[:, 5] - found[:, 6] - found[:, 7]).max() < 1e-6 * found[:, 7].max()


PHASES = [(0.25, 20.0, 100.0, 100.0), (0.25, 20.0, 300.0, 0.0), (0.25, 20.0, 500.0, 0.0), (0.5, 20.0, 0.0, 400.0)]


@dataclass
class Plates:
    """Coulomb's law, written from the physics. State: speeds of side gears and wheels, twists, pressing torque.

    *mode*: 0 stuck, 1 the left side is faster, -1 the right one.
    """

    loads: tuple[float, ...] = (0.0, 0.0, 0.0)
    mode: int = 0

    def parts(self, y: Rows) -> tuple[float, float, float, float, float]:
        """Torques of the shafts and the carrier, the capacity of the plates and what they move, N.m."""
        left = STIFFNESS * y[4] + DAMPING * (y[0] - y[2])
        right = STIFFNESS * y[5] + DAMPING * (y[1] - y[3])
        inertia = ENGINE * RATIO / 2 / SIDE
        carrier = (self.loads[0] + inertia * (left + right)) / (1 / RATIO + inertia)
        capacity = PRELOAD + LOCKING * y[6]
        return left, right, carrier, capacity, 0.5 * (right - left) if self.mode == 0 else self.mode * capacity

    def derivative(self, _: float, y: Rows) -> list[float]:
        """Of the state."""
        left, right, carrier, _, moved = self.parts(y)
        return [
            (0.5 * carrier - moved - left) / SIDE, (0.5 * carrier + moved - right) / SIDE,
            left - self.loads[1], right - self.loads[2], y[0] - y[2], y[1] - y[3], (abs(carrier) - y[6]) / LAG,
        ]  # fmt: skip

    def change(self, y: Rows) -> Rows:
        """The state from which the next mode begins."""
        if self.mode == 0:
            self.mode = 1 if self.parts(y)[4] > 0 else -1
            return np.array([y[0] + 1e-12 * self.mode, *y[1:]])
        self.mode = 0
        return np.array([*[0.5 * (y[0] + y[1])] * 2, *y[2:]])


def plates(times: Rows) -> Rows:
    """Speeds of the wheels, slip and moved torque at *times*, by scipy from event to event."""
    system, rows, now, state = Plates(), [], 0.0, np.zeros(7)

    def ends(_: float, y: Rows) -> float:
        *_, capacity, moved = system.parts(y)
        return float(capacity - abs(moved) if system.mode == 0 else system.mode * (y[0] - y[1]))

    ends.terminal, ends.direction = True, -1  # type: ignore[attr-defined]
    for duration, *loads in PHASES:
        system.loads = tuple(loads)
        until = now + duration
        while now < until - 1e-9:
            done = solve_ivp(
                system.derivative, (now, until), state, "Radau", events=ends, dense_output=True, rtol=1e-10, atol=1e-10
            )
            wanted = [min(t, until) for t in times if now + 1e-9 < t < done.t[-1] + 1e-9]
            rows += [[*y, system.parts(y)[4]] for y in map(done.sol, wanted)]
            now, state = float(done.t[-1]), done.y[:, -1]
            if done.status == 1:
                state = system.change(done.y_events[0][0])
    found = np.array(rows)
    return np.column_stack((found[:, 2], found[:, 3], found[:, 0] - found[:, 1], found[:, 7]))


@pytest.mark.thorough
def test_plates_stick_slip_and_stick_again_as_coulomb_says(cache: Path) -> None:
    names = ("left_speed", "right_speed", "slip", "moved", "work", "loss", "whole_energy")
    found = driven("LimitedSlip", names, PHASES, 1.0, cache)
    expected = plates(found[:, 0])
    scale = np.abs(expected).max(axis=0)
    # A slip counts from 1e-4 rad/s on (start_speed of the clutch).
    assert np.abs(found[:, 1:3] - expected[:, :2]).max() < 1e-5 * scale[0]
    assert np.abs(found[:, 3] - expected[:, 2]).max() < 1e-4
    settled = np.abs(expected[:, 3] - np.roll(expected[:, 3], 1)) < 20  # not where it sticks or lets go in between
    assert np.abs(found[:, 4] - expected[:, 3])[settled].max() < 0.1
    slipping = np.abs(found[:, 3]) > 1e-3
    assert not slipping[(found[:, 0] < 0.25) | ((found[:, 0] > 0.3) & (found[:, 0] < 0.5))].any()
    assert slipping[(found[:, 0] > 0.51) & (found[:, 0] < 0.69)].all()
    assert np.abs(found[:, 5] - found[:, 6] - found[:, 7]).max() < 1e-6 * found[:, 7].max()


@pytest.mark.thorough
def test_the_lock_moves_the_torque_that_one_wheel_cannot_hold_to_the_other_one(cache: Path) -> None:
    """A wheel on ice (150 N.m at most) and one that moves the car; both powertrains account for their energy."""
    names = tuple(f"energy_{name}" for name in ("in", "out", "loss", "stored"))
    reached = {}
    for model in ("CombustionOpenDifferential", "CombustionLimitedSlip"):
        bench = Bench(opened(f"AdasPowertrain.Powertrains.{model}", cache), 1e-7, {"torque_demand": 1500.0})
        speeds, stored, moved = np.zeros(2), bench.get(names)[3], 0.0
        for k in range(3000):
            torques = np.array(bench.get(["wheel_torque[1]", "wheel_torque[2]"]))
            speeds += 1e-3 * (torques - [150.0 * math.tanh(speeds[0]), 20.0]) / [1.0, 154.0]
            bench.set({"wheel_speeds[1]": speeds[0], "wheel_speeds[2]": speeds[1]})
            bench.step(1e-3 * k, 1e-3)
            moved += 1e-3 * (torques[1] - torques[0])
        drawn, given, lost, kept = bench.get(names)
        bench.close()
        assert abs(drawn - given - lost - (kept - stored)) < 1e-6 * drawn
        reached[model] = speeds[1], moved / 3.0
    (slow, none), (fast, some) = reached.values()
    assert abs(none) < 1e-6
    assert some > 80.0
    assert fast > 1.5 * slow
