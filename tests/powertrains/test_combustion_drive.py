"""Combustion powertrains in a car against models written from the physics, integrated event by event with DOP853."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bench import opened, run
from combustion import CAR, ENERGY_IN, ENERGY_LOSS, ENGINE, TWIST, CombustionCar
from combustion_gears import SEVEN_SPEED, SIX_SPEED, Curve
from combustion_hybrid import HybridCar
from hybrid_system import integrate

TIMES = np.linspace(0.0, 28.0, 281)
DEMAND = Curve((0, 1, 3, 12, 13, 20, 21, 26, 28, 40), (0, 0, 1500, 1500, 0, 0, 900, 900, 0, 0))
NAMES = (
    "speed", "powertrain.engine.speed", "powertrain.shaft.twist", "powertrain.energy_in", "powertrain.energy_loss",
    "powertrain.energy_out", "powertrain.energy_stored",
)  # fmt: skip


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Path:
    return built_before(tmp_path_factory.mktemp("combustion"))


def reference(model: str, initial_speed: float = 0.0) -> CombustionCar:
    gears = SIX_SPEED if model == "Automatic" else SEVEN_SPEED
    return CombustionCar(DEMAND, gears, model == "Automatic", initial_speed)


@pytest.mark.parametrize("initial_speed", [0.0, 25.0])
@pytest.mark.parametrize("model", ["Automatic", "DualClutch"])
@pytest.mark.thorough
def test_a_car_with_a_combustion_powertrain_moves_as_the_physics_says(
    model: str, initial_speed: float, cache: Path
) -> None:
    car = reference(model, initial_speed)
    expected = integrate(car, car.start(), TIMES, 1e-11, 0.05)
    found = run(opened(f"Combustion.{model}", cache), NAMES, TIMES, 1e-8, {"initial_speed": initial_speed})
    assert len(expected.events) > 10  # shifts, clutches and fuel cut are part of it
    assert np.abs(found[:, 0] - expected.states[:, CAR]).max() < 5e-7  # m/s; 1e-6 is asked for
    assert np.abs(found[:, 1] - expected.states[:, ENGINE]).max() < 5e-5  # rad/s
    assert np.abs(found[:, 2] - expected.states[:, TWIST]).max() < 1e-7  # rad
    # Where the throttle is open, the fuel's line has a kink that is no event: steps over it cost a digit.
    assert found[-1, 3] == pytest.approx(expected.states[-1, ENERGY_IN], rel=1e-7)
    assert found[-1, 4] == pytest.approx(expected.states[-1, ENERGY_LOSS], rel=1e-7)


@pytest.mark.thorough
def test_parameters_reach_every_part(cache: Path) -> None:
    starts = {
        "powertrain.final_ratio": 3.9,
        "powertrain.engine_inertia": 0.2,
        "powertrain.shift_time": 0.6,
        "powertrain.shaft_stiffness": 7e3,
        "powertrain.shaft_damping": 90.0,
        "powertrain.gearbox_data.up_calm": 230.0,
        "powertrain.gearbox_data.efficiency": 0.95,
        "powertrain.engine_data.air_lag": 0.2,
        "mass": 1400.0,
    }
    car = reference("Automatic")
    gears = replace(SIX_SPEED, final=3.9, shift_time=0.6, up=(230.0, 600.0), efficiency=0.95)
    car = CombustionCar(
        DEMAND, gears, True, petrol=replace(car.petrol, air_lag=0.2), mass=1400.0,
        engine_inertia=0.2, stiffness=7e3, damping=90.0,
    )  # fmt: skip
    expected = integrate(car, car.start(), TIMES, 1e-10, 0.05)
    found = run(opened("Combustion.Automatic", cache), NAMES, TIMES, 1e-8, starts)
    assert np.abs(found[:, 0] - expected.states[:, CAR]).max() < 5e-7
    assert np.abs(found[:, 1] - expected.states[:, ENGINE]).max() < 5e-5


@pytest.mark.thorough
def test_the_hybrid_gearbox_moves_as_the_physics_says(cache: Path) -> None:
    points = (0, 1, 2, 6, 7, 12, 13, 18, 20, 30)
    times = np.linspace(0.0, 30.0, 301)
    car = HybridCar(
        engine=Curve(points, (0, 0, 0, 0, -15, 120, 120, 60, -20, -20)),
        machine=Curve(points, (0, 0, 100, 100, 60, 40, 80, -60, -60, 0)),
        clutch=Curve(points, (0, 0, 0, 0, 0.3, 1, 1, 1, 1, 0)),
    )
    expected = integrate(car, car.start(), times, 1e-11, 0.05)
    names = ("speed", "gearbox.engine_speed", "gearbox.energy_in", "gearbox.energy_loss",
             "gearbox.energy_out", "gearbox.energy_stored")  # fmt: skip
    found = run(opened("Combustion.HybridGearboxInCar", cache), names, times, 1e-8)
    assert len(expected.events) > 10  # K0 closes and opens, gears shift
    assert np.abs(found[:, 0] - expected.states[:, 5]).max() < 5e-7
    assert np.abs(found[:, 1] - expected.states[:, 0]).max() < 5e-5
    assert found[-1, 2:4] == pytest.approx(expected.states[-1, [6, 8]], rel=1e-7)
    drawn, lost, given, kept = found[-1, 2:]
    assert abs(drawn - given - lost - (kept - found[0, 5])) < 1e-7 * np.ptp(found[:, 2])


@pytest.mark.thorough
def test_the_quasi_static_car_uses_nearly_what_the_dynamic_one_uses(cache: Path) -> None:
    names = ("speed", "powertrain.energy_in")
    dynamic = run(opened("Combustion.Automatic", cache), names, TIMES, 1e-6)
    static = run(opened("Combustion.QuasiStatic", cache), names, TIMES, 1e-6)
    assert np.abs(dynamic[:, 0] - static[:, 0]).max() < 4.0  # m/s: lags and inertias are what differs
    assert static[-1, 1] == pytest.approx(dynamic[-1, 1], rel=0.1)
