"""Range extender and P2 hybrid: their parts coupled without delay against the physics, and as FMUs at 10 ms steps."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from bench import Bench, lacking, on_cycle, opened, run
from combustion_hybrid import CAR
from coupled import HYBRID, RANGE_EXTENDER, drive
from electric import Car
from electric_drive import demand
from hybrid_drive import CHARGE, HybridDrive
from hybrid_system import integrate
from range_extender import RangeExtenderCar

PARTS = "AdasPowertrain.Parts."
ENERGIES = ("energy_in", "energy_out", "energy_loss", "energy_stored")
EXTENDED = {
    "machine": PARTS + "Machine",
    "battery": PARTS + "Battery",
    "generator": PARTS + "GeneratorSet",
    "control": PARTS + "SeriesControl",
    "axle": PARTS + "SingleSpeedAxle",
}
PARALLEL = {
    "engine": PARTS + "Engine15",
    "machine": PARTS + "Machine",
    "battery": PARTS + "Battery",
    "gearbox": PARTS + "HybridGearbox",
    "control": PARTS + "HybridControl",
}
STARTS: Mapping[str, Mapping[str, float]] = {
    "battery": {"initial_soc": 0.4805},
    "control": {"start_soc": 0.475, "stop_soc": 0.4755, "averaging": 5.0},
}


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Path:
    return built_before(tmp_path_factory.mktemp("hybrid"))


@pytest.mark.thorough
def test_a_car_with_range_extender_moves_as_the_physics_says(cache: Path) -> None:
    times = np.linspace(0.0, 60.0, 241)
    car = RangeExtenderCar()
    states = integrate(car, car.start(), times, 1e-11, 0.05).states
    rows = run(
        opened("Electric.RangeExtenderInCar", cache), ("speed", "soc", "generator.speed", *ENERGIES), times, 1e-8
    )
    assert np.abs(rows[:, 0] - states[:, 0]).max() < 1e-6 / 10
    assert np.abs(rows[:, 1] - states[:, 5] / car.battery.capacity).max() < 1e-9
    assert np.abs(rows[:, 2] - states[:, 8]).max() < 1e-3
    assert np.abs(rows[:, 3] - states[:, 11]).max() < 1e-8 * states[:, 11].max()
    assert lacking(rows[:, 3:]) < 1e-9
    # The generator starts at low charge and stops only after its least time, though the charge is back sooner.
    running = states[:, 8] > 150
    assert times[running][0] < 11
    assert 28 < times[running & (times < 40)][-1] < 32
    assert (states[times < 25, 5].max() / car.battery.capacity) > car.stop_soc


@pytest.mark.thorough
def test_a_car_with_p2_hybrid_moves_as_the_physics_says(cache: Path) -> None:
    times = np.linspace(0.0, 40.0, 161)
    car = HybridDrive()
    states = integrate(car, car.start(), times, 1e-11, 0.02).states
    rows = run(opened("Electric.HybridInCar", cache), ("speed", "soc", *ENERGIES), times, 1e-8)
    assert np.abs(rows[:, 0] - states[:, CAR]).max() < 1e-6 / 5
    assert np.abs(rows[:, 1] - states[:, CHARGE] / car.battery.capacity).max() < 1e-8
    assert lacking(rows[:, 2:]) < 1e-9
    assert car.starts_of_engine == 1  # cranked by the machine …
    assert not car.is_on  # … and stopped again


@pytest.mark.parametrize("architecture", ["RangeExtender", "Hybrid", "Equivalent"])
@pytest.mark.thorough
def test_energy_is_kept_over_a_cycle_and_the_charge_comes_back(cache: Path, architecture: str) -> None:
    names = ("speed", "car.distance", "soc", *ENERGIES)
    found = on_cycle(opened(f"Electric.{architecture}OnCycle", cache), names, 1.0)
    assert lacking(found[:, 3:]) < 1e-6
    assert found[:, 2].min() > 0.4
    assert found[:, 2].max() < 0.6
    kilowatt_hours = found[-1, 3] / 3.6e6 / (found[-1, 1] / 1e5)
    assert 35 < kilowatt_hours < 60  # 4 to 6.7 l petrol per 100 km


@pytest.mark.thorough
def test_the_engine_gets_the_torque_of_least_equivalent_consumption(cache: Path) -> None:
    """Against a search over a grid: within the grid's spacing, and never with a larger sum than any point of it."""

    def total(engine: np.ndarray | float) -> np.ndarray | float:
        machine = wanted - engine
        electric = machine * speed + 5.4 * np.abs(machine) + 0.047 * machine**2
        combustion = engine + 25
        charge = np.where(combustion < 162, combustion * 150 / 162, combustion - 12)
        fuel = charge + 0.3 * 150 * np.maximum(0, charge / 150 - 1) ** 2
        return fuel * speed / 0.4 + price * (electric + 2.5e-6 * electric**2)

    grid = np.linspace(10.0, 200.0, 1901)
    bench, found = Bench(opened("Electric.SplitBench", cache), 1e-6), []
    for wanted, speed, price in product((-50.0, 5.0, 40.0, 120.0, 300.0), (100.0, 250.0), (2.2, 2.8, 3.4)):
        bench.set({"shaft_torque": wanted, "speed": speed, "equivalence": price})
        bench.step(0.1 * len(found), 0.1)
        (torque,) = bench.get(["torque"])
        found.append(torque)
        assert torque == pytest.approx(grid[np.argmin(total(grid))], abs=0.1)
        assert total(torque) <= total(grid).min() + 1e-6 * abs(total(torque))
    bench.close()
    assert {10.0, 200.0} < set(np.round(found, 3))  # both limits, and what is between them


@pytest.mark.thorough
def test_least_equivalent_consumption_burns_less_than_rules(cache: Path) -> None:
    """The same car, cycle and battery; fuel for the battery's change at 33 % (engine 36 %, charging 92 %)."""
    names = ("speed", "energy_in", "battery.energy_in", "soc")
    burned = []
    for strategy in ("Hybrid", "Equivalent"):
        _, drawn, discharged, soc = on_cycle(opened(f"Electric.{strategy}OnCycle", cache), names, 1.0)[-1]
        assert abs(soc - 0.5) < 0.06
        burned.append(drawn - discharged + discharged / 0.33)
    assert burned[1] < 0.92 * burned[0]


@pytest.mark.thorough
def test_a_small_battery_is_asked_for_what_it_can_give_and_the_engine_gives_the_rest(cache: Path) -> None:
    """96 cells of 1.5 A.h with 0.12 of the resistance of energy cells: Ohm's law for 2.8 and 4.2 V."""
    names = ("speed", "cell_voltage", "electric", "soc")
    speed, volts, power, soc = on_cycle(opened("Electric.SmallBatteryOnCycle", cache), names, 1.0).T
    resistance = 0.12 * (227.8 + 142.9 + 152.5) * 96 / 5400
    least, most, rest = 96 * 2.8, 96 * 4.2, 96 * 3.85  # at most 3.85 V at 65 % of the charge
    assert soc.max() < 0.65
    assert power.max() < least * (rest - least) / resistance - 350
    assert power.min() > -most * (most - 96 * 3.77) / resistance - 350  # at least 3.77 V at 40 %
    assert soc.min() > 0.39
    assert volts.min() > 2.8
    assert volts.max() < 4.2
    unknown = on_cycle(opened("Electric.UnknownSmallBatteryOnCycle", cache), names, 1.0).T
    assert np.abs(speed - unknown[0]).max() < 1.0  # the car drives as if it had more
    assert unknown[2].max() > 1.5 * power.max()
    assert unknown[2].min() < 1.5 * power.min()


@pytest.mark.thorough
def test_the_energy_of_the_hybrid_with_temperatures_is_found_in_full_wherever_it_went(cache: Path) -> None:
    """Over the cycle from -7 degrees: fuel and battery against work, heat to the air, and what all masses store.

    Heats are integrated from the temperatures; of the parts' own accounts, only the gearbox's is used. A sum of
    integrals is exact in every step of the solver; only kinetic energy, a square, is as exact as the tolerance of 1e-6.
    """
    heats = ("exhaust", "gears", "used", "air", "radiators")
    kelvins = tuple(f"{part}_kelvin" for part in ("engine", "machine", "battery", "coolant"))
    names = ("speed", "given", "wheel_work", "motion", *heats, *kelvins)
    found = on_cycle(opened("Electric.ThermalHybridOnCycle", cache), names, 1.0)
    given, work, motion = found[:, 1:4].T
    warmed = (found[:, 9:] - 266.15) @ [65e3, 20e3, 8.44e-3 * 108 * 28800, 15e3]
    missing = given - work - (motion - motion[0]) - found[:, 4:9].sum(axis=1) - warmed
    assert np.abs(missing).max() < 1e-6 * given.max()
    assert min(work[-1], warmed[-1], *found[-1, 4:9]) > 1e-2 * given[-1]  # none of them could be missing


def coupled(cache: Path, step: float, stop: float) -> np.ndarray:
    """Rows of the range extender's parts, each *step* seconds until *stop*."""
    watched = [
        ("battery", "soc"), ("axle", "torque_rear"), ("battery", "energy_out"), ("machine", "energy_in"),
        ("generator", "energy_out"), ("machine", "energy_out"), ("axle", "energy_in"),
    ]  # fmt: skip
    car = Car(mass=1500.0, wheel_radius=0.34, drag_area=0.70)
    return drive(EXTENDED, STARTS, RANGE_EXTENDER, car, demand, watched, stop, cache, step)


@pytest.mark.thorough
def test_parts_coupled_by_signals_at_ten_milliseconds_move_the_car_nearly_like_one_model(cache: Path) -> None:
    rows = coupled(cache, 0.01, 40.0)
    exact = run(opened("Electric.RangeExtenderInCar", cache), ("speed", "soc"), rows[:, 0], 1e-8)
    apart = np.abs(rows[:, 1] - exact[:, 0])
    assert apart.max() < 0.3  # the demand's steps of 4 kN.m arrive a few communication steps late
    assert np.abs(rows[:, 2] - exact[:, 1]).max() < 1e-4
    # What one part gives and what the next one takes differ by the delay of one step.
    entered = rows[-1, 5] - rows[-1, 6]
    assert rows[-1, 4] == pytest.approx(entered, rel=5e-3)
    assert rows[-1, 8] == pytest.approx(rows[-1, 7], rel=5e-3)
    finer = coupled(cache, 0.0025, 10.0)
    exact = run(opened("Electric.RangeExtenderInCar", cache), ("speed",), finer[:, 0], 1e-8)
    assert np.abs(finer[:, 1] - exact[:, 0]).max() < 0.5 * apart[rows[:, 0] < 10].max()


@pytest.mark.thorough
def test_the_parts_of_the_p2_hybrid_are_stable_at_ten_milliseconds(cache: Path) -> None:
    watched = [("gearbox", "torque_front"), ("gearbox", "engine_speed"), ("gearbox", "machine_speed")]
    car = Car(mass=1550.0, wheel_radius=0.32, drag_area=0.66)
    starts = {"battery": {"capacity": 111600.0, "resistance_share": 0.4}}
    rows = drive(PARALLEL, starts, HYBRID, car, lambda time: 0.5 * demand(time), watched, 40.0, cache)
    names = ("speed", "gearbox.torque_front", "gearbox.engine_speed")
    exact = run(opened("Electric.HybridInCar", cache), names, rows[:, 0], 1e-8)
    assert np.abs(rows[:, 1] - exact[:, 0]).max() < 0.3
    calm = (rows[:, 0] > 20) & (rows[:, 0] < 26)
    assert np.abs(np.diff(rows[calm, 2])).max() < 5  # N.m from step to step: nothing rings
    assert abs(rows[calm, 4] - rows[calm, 3]).min() > 50  # engine off, K0 open


@pytest.mark.thorough
def test_wheels_that_spin_freely_do_not_make_the_parts_unstable(cache: Path) -> None:
    rows = drive(
        EXTENDED, {}, RANGE_EXTENDER, Car(), lambda time: 100.0 if 0.5 < time < 1 else 0.0,
        [("axle", "torque_rear")], 4.0, cache, wheel_inertia=2.0,
    )  # fmt: skip
    assert np.abs(rows[:, 2]).max() < 200
    assert np.abs(rows[rows[:, 0] > 3, 2]).max() < 5
