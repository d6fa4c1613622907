"""Battery-electric powertrains in a car against models written from the physics, integrated event by event."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from bench import Bench, lacking, on_cycle, opened, run
from electric import Battery, SynchronousMachine
from electric_drive import DynamicDrive, QuasiStaticDrive
from hybrid_system import integrate
from scipy.interpolate import CubicHermiteSpline

TIMES = np.linspace(0.0, 30.0, 121)
ENERGIES = tuple(f"powertrain.energy_{what}" for what in ("in", "out", "loss", "stored"))


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Path:
    return built_before(tmp_path_factory.mktemp("electric"))


@pytest.fixture(scope="session")
def dynamic() -> tuple[DynamicDrive, np.ndarray]:
    drive = DynamicDrive()
    return drive, integrate(drive, drive.start(), TIMES, 1e-11, 0.1).states


class LossMap:
    """The quasi-static machine's map, read from the FMU, with splines of scipy over it."""

    def __init__(self, cache: Path) -> None:
        bench = Bench(opened("AdasPowertrain.Powertrains.BatteryElectricQuasiStatic", cache), 1e-6)
        every = range(1, 14)
        self.speeds = np.array(bench.get([f"machine.speed_axis[{i}]" for i in every]))
        self.shares = np.array(bench.get([f"machine.share_axis[{i}]" for i in every]))
        self.losses = np.array([bench.get([f"machine.loss_map[{i},{j}]" for j in every]) for i in every])
        bench.close()
        self._rows = [CubicHermiteSpline(self.shares, row, slopes(self.shares, row)) for row in self.losses]

    def __call__(self, spin: float, share: float) -> float:
        values = np.array([row(share) for row in self._rows])
        return float(CubicHermiteSpline(self.speeds, values, slopes(self.speeds, values))(abs(spin)))


def slopes(xs: np.ndarray, ys: np.ndarray) -> np.ndarray:
    """Of the parabola through each point and its neighbours, or through the three at an end."""
    found = []
    for i, x in enumerate(xs):
        near = slice(k := min(max(i - 1, 0), len(xs) - 3), k + 3)
        found.append(np.polyfit(xs[near] - x, ys[near], 2)[1])
    return np.array(found)


@pytest.fixture(scope="session")
def loss_map(cache: Path) -> LossMap:
    return LossMap(cache)


@pytest.mark.thorough
def test_a_battery_electric_car_moves_as_the_physics_says(
    cache: Path, dynamic: tuple[DynamicDrive, np.ndarray]
) -> None:
    drive, states = dynamic
    names = ("speed", "soc", "powertrain.machine.speed", *ENERGIES)
    rows = run(opened("Electric.BatteryElectricInCar", cache), names, TIMES, 1e-8)
    assert np.abs(rows[:, 0] - states[:, 0]).max() < 1e-6 / 10  # the requirement is 1e-6 m/s
    assert np.abs(rows[:, 1] - states[:, 5] / drive.battery.capacity).max() < 1e-9
    assert np.abs(rows[:, 2] - states[:, 1]).max() < 1e-4
    assert np.abs(rows[:, 3] - states[:, 8]).max() < 1e-8 * states[:, 8].max()
    assert np.abs(rows[:, 5] - states[:, 10]).max() < 1e-8 * states[:, 10].max()
    assert states[:, 0].max() > 35  # the field is weakened, the battery limits, the recuperation is limited by power
    assert lacking(rows[:, 3:]) < 1e-9


@pytest.mark.thorough
def test_a_car_with_temperatures_moves_with_their_resistances_and_warms_as_the_losses_say(cache: Path) -> None:
    """At 20 degrees, kept by great heat capacities: the car with the copper and the cells of that temperature."""
    copper, cells = 1 / (1 + 0.00393 * 80), math.exp(20e3 / 8.314 * (1 / 293.15 - 1 / 298.15))
    drive = DynamicDrive(
        machine=SynchronousMachine(stator_resistance=0.007 * copper),
        battery=Battery(series=227.8 * cells, pairs=((142.9 * cells, 32.85 * cells), (152.5 * cells, 223.0 * cells))),
    )
    states = integrate(drive, drive.start(), TIMES, 1e-11, 0.1).states
    names = ("speed", "soc", "heat", "air", "machine_kelvin", "battery_kelvin", "coolant_kelvin", *ENERGIES)
    model = opened("Electric.ThermalElectricInCar", cache)
    kept = run(model, names, TIMES, 1e-8, {"powertrain.machine_capacity": 1e12, "powertrain.specific_heat": 1e6})
    assert np.abs(kept[:, 0] - states[:, 0]).max() < 1e-6
    assert np.abs(kept[:, 1] - states[:, 5] / drive.battery.capacity).max() < 1e-8
    assert kept[-1, 9] == pytest.approx(states[-1, 10], rel=1e-7)
    rows = run(model, names, TIMES, 1e-8)
    warmed = (rows[:, 4:7] - 293.15) @ [20e3, 3.81e-3 * 108 * 561600, 15e3]
    assert np.abs(rows[:, 2] - rows[:, 3] - warmed).max() < 1e-8 * rows[-1, 2]
    assert rows[-1, 4] > 297
    assert rows[-1, 2] < 0.9995 * kept[-1, 2]  # warmer cells lose less, by more than warmer copper loses more
    assert lacking(rows[:, 7:]) < 1e-9


@pytest.mark.thorough
def test_a_quasi_static_electric_car_moves_as_the_physics_says(cache: Path, loss_map: LossMap) -> None:
    drive = QuasiStaticDrive(loss=loss_map)
    states = integrate(drive, drive.start(), TIMES[::4], 1e-11, 0.1).states
    rows = run(opened("Electric.QuasiStaticInCar", cache), ("speed", "soc", *ENERGIES), TIMES[::4], 1e-8)
    assert np.abs(rows[:, 0] - states[:, 0]).max() < 1e-6
    assert np.abs(rows[:, 1] - states[:, 1] / drive.battery.capacity).max() < 1e-8
    assert np.abs(rows[:, 2] - states[:, 2]).max() < 1e-6 * states[:, 2].max()
    assert lacking(rows[:, 2:]) < 1e-12


@pytest.mark.thorough
def test_the_error_falls_with_the_order_of_the_solver(cache: Path) -> None:
    drive = DynamicDrive()
    exact = integrate(drive, drive.start(), np.array([0.0, 2.5]), 1e-12, 0.05).states[-1, 0]
    model, errors = opened("Electric.BatteryElectricInCar", cache), []
    for steps in (200, 400, 800):
        # With so loose a tolerance every communication step is one step of Dormand and Prince.
        rows = run(model, ("speed",), np.linspace(0.0, 2.5, steps + 1), 0.5)
        errors.append(abs(rows[-1, 0] - exact))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert (orders > 4.5).all(), errors


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("fidelity", ["QuasiStatic", "BatteryElectric"])
def test_energy_is_kept_over_a_cycle_and_the_consumption_is_that_of_such_cars(cache: Path, fidelity: str) -> None:
    names = ("speed", "car.distance", *ENERGIES)
    found = on_cycle(opened(f"Electric.{fidelity}OnCycle", cache), names, 0.3)
    assert lacking(found[:, 2:]) < 1e-6
    kilowatt_hours = found[-1, 2] / 3.6e6 / (found[-1, 1] / 1e5)
    assert (
        12 < kilowatt_hours < 20
    )  # Volkswagen states 15.4 to 16.6 kWh/100 km for the ID.3 Pro by WLTP, charging counted in


@pytest.mark.thorough
def test_the_loss_map_is_that_of_the_dynamic_machine(loss_map: LossMap) -> None:
    machine = SynchronousMachine()
    for spin, row in zip(loss_map.speeds, loss_map.losses, strict=True):
        torque = machine.torque_limit(spin, 396.0)
        expected = [machine.losses(share * torque, spin, 396.0) for share in loss_map.shares]
        assert np.abs(row - expected).max() <= 0.5


@pytest.mark.thorough
def test_a_powertrain_that_starts_in_motion_is_at_rest_inside(cache: Path) -> None:
    model = opened("AdasPowertrain.Powertrains.BatteryElectric", cache)
    bench = Bench(model, 1e-6, {"wheel_speed_front": 60.0, "wheel_speed_rear": 60.0})
    assert bench.get(["machine.speed"]) == pytest.approx([60.0 * 11.53])
    torques = []
    for k in range(100):
        bench.step(0.01 * k, 0.01)
        torques += bench.get(["torque_rear"])
    bench.close()
    assert max(abs(torque) for torque in torques) < 50  # drag of the gears only


@pytest.mark.thorough
def test_recuperation_fades_towards_standstill_and_stops_when_the_battery_is_full(cache: Path) -> None:
    model = opened("AdasPowertrain.Powertrains.BatteryElectricQuasiStatic", cache)

    def torque(wheel_speed: float, soc: float) -> float:
        speeds = {"wheel_speed_front": wheel_speed, "wheel_speed_rear": wheel_speed}
        bench = Bench(model, 1e-6, {**speeds, "initial_soc": soc, "torque_demand": -2000.0})
        bench.set({**speeds, "torque_demand": -2000.0})
        bench.step(0.0, 0.01)
        found = bench.get(["torque_rear"])[0]
        bench.close()
        return found

    assert torque(40.0, 0.5) < -1400
    assert -50 < torque(0.3, 0.5) <= 0
    assert abs(torque(40.0, 0.985)) < 50  # what is left are the gears' losses
