"""Machine, battery, generator set and controls as FMUs of their own, against closed forms and rules."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
from bench import Bench, opened
from electric import Battery, SynchronousMachine
from range_extender import GOLF, GeneratorSet, on_line
from scipy.integrate import solve_ivp

PARTS = "AdasPowertrain.Parts."
PRIUS = SynchronousMachine(
    max_torque=207.0,
    max_power=60e3,
    flux_linkage=0.12,
    inductance=4e-4,
    stator_resistance=0.025,
    hysteresis_loss=20.0,
    eddy_loss=0.008,
    viscous_friction=3e-4,
)


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Path:
    return built_before(tmp_path_factory.mktemp("parts"))


def settled(cache: Path, part: str, inputs: Mapping[str, float], names: tuple[str, ...], after: float) -> list[float]:
    """Values of *names* when *inputs* have stood for *after* seconds."""
    bench = Bench(opened(PARTS + part, cache), 1e-9)
    bench.set(inputs)
    bench.step(0.0, after)
    found = bench.get(names)
    bench.close()
    return found


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("part", "data"), [("Machine", GOLF), ("Machine60kW", PRIUS)])
@pytest.mark.parametrize("spin", [0.0, 150.0, 500.0, 1000.0])
@pytest.mark.parametrize("asked", [-1000.0, 40.0, 1000.0])
@pytest.mark.thorough
def test_the_machine_gives_the_torque_of_its_envelope_and_the_losses_of_its_currents(
    cache: Path, part: str, data: SynchronousMachine, spin: float, asked: float
) -> None:
    inputs = {"torque_demand": asked, "shaft_speed": spin, "voltage": 340.0}
    torque, power = settled(cache, part, inputs, ("torque", "electric_power"), 3.0)
    limit = data.torque_limit(spin, 340.0)
    assert torque == pytest.approx(max(-limit, min(limit, asked)), rel=1e-7)
    assert power == pytest.approx(torque * spin + data.losses(torque, spin, 340.0), rel=1e-6)


def test_the_machines_torque_follows_with_its_lag(cache: Path) -> None:
    bench = Bench(opened(PARTS + "Machine", cache), 1e-10)
    bench.set({"torque_demand": 100.0, "shaft_speed": 100.0, "voltage": 350.0})
    for k in range(20):
        bench.step(0.005 * k, 0.005)
        assert bench.get(["torque"])[0] == pytest.approx(100 * (1 - math.exp(-0.005 * (k + 1) / 0.02)), abs=1e-6)
    entered, left, lost = bench.get(["energy_in", "energy_out", "energy_loss"])
    bench.close()
    assert entered == pytest.approx(left + lost, rel=1e-9)
    # Work of a torque that rises exponentially at constant speed.
    assert left == pytest.approx(100 * 100 * (0.1 - 0.02 * (1 - math.exp(-5))), rel=1e-7)


@pytest.mark.parametrize("power", [40e3, -30e3])
@pytest.mark.thorough
def test_the_battery_is_the_circuit_of_its_cells(cache: Path, power: float) -> None:
    data = Battery(series_cells=96, capacity=338400.0)
    times = np.linspace(0.0, 600.0, 61)

    def slopes(time: float, y: np.ndarray) -> list[float]:
        current = data.current(power + 350.0, data.open_circuit(y[0]) - y[1] - y[2])
        return [-current, *data.flows(current, y[1:])[0]]

    exact = solve_ivp(slopes, (0, 600), [0.5 * 338400, 0, 0], "DOP853", times, rtol=1e-12, atol=1e-9, max_step=5).y
    bench = Bench(opened(PARTS + "Battery", cache), 1e-9)
    bench.set({"electric_power": power})
    rows = []
    for k in range(60):
        bench.step(10.0 * k, 10.0)
        rows.append(bench.get(["soc", "voltage", "energy_in", "energy_out", "energy_loss", "energy_stored"]))
    bench.close()
    found = np.array(rows)
    assert np.abs(found[:, 0] - exact[0, 1:] / 338400).max() < 1e-8
    current = data.current(power + 350.0, data.open_circuit(exact[0, -1]) - exact[1, -1] - exact[2, -1])
    assert found[-1, 1] == pytest.approx((power + 350.0) / current, rel=1e-7)
    entered, left, lost, stored = found[-1, 2:]
    assert entered == pytest.approx(left + lost + stored, abs=1e-7 * abs(entered))
    assert found[-1, 3] == pytest.approx(600 * power, rel=1e-9)
    assert 0.9 < abs(left / entered if power > 0 else entered / left) < 0.98


def test_a_generator_unloads_the_battery(cache: Path) -> None:
    names = ("battery_power",)
    alone = settled(cache, "Battery", {"electric_power": 20e3}, names, 1.0)[0]
    helped = settled(cache, "Battery", {"electric_power": 20e3, "charging_power": 20e3}, names, 1.0)[0]
    assert alone > 20e3
    assert 350 < helped < 360


def test_more_power_than_the_battery_has_is_refused(cache: Path) -> None:
    with pytest.raises(AssertionError, match="more power is asked than the battery can give"):
        settled(cache, "Battery", {"electric_power": 5e6}, ("soc",), 1.0)


@pytest.mark.parametrize("power", [4e3, 12e3, 22e3])
@pytest.mark.thorough
def test_the_generator_set_settles_on_its_line(cache: Path, power: float) -> None:
    names = ("speed", "electric_power", "fuel_power", "co2")
    turning, fed, fuel, carbon = settled(cache, "GeneratorSet", {"power_demand": power}, names, 20.0)
    data = GeneratorSet()
    torque = min(55.0, data.wanted_torque(power, on_line(power)))
    _, expected, burned, _ = data.flows(on_line(power), torque + data.friction(on_line(power)), on_line(power))
    assert turning == pytest.approx(on_line(power), rel=1e-7)
    assert fed == pytest.approx(expected, rel=1e-6)
    assert fed == pytest.approx(power, rel=0.05)
    assert fuel == pytest.approx(burned, rel=1e-6)
    assert 0.25 < fed / fuel < 0.34
    assert carbon == pytest.approx(fuel * 73.4e-9, rel=1e-6)


def test_starting_and_stopping_the_generator_set_keeps_its_energy(cache: Path) -> None:
    bench = Bench(opened(PARTS + "GeneratorSet", cache), 1e-9)
    powers = []
    for k in range(400):
        bench.set({"power_demand": 15e3 if 50 <= k < 250 else 0.0})
        bench.step(0.05 * k, 0.05)
        powers += bench.get(["electric_power"])
    entered, left, lost, stored = bench.get(["energy_in", "energy_out", "energy_loss", "energy_stored"])
    bench.close()
    assert min(powers) < -1000  # the battery cranks
    assert entered == pytest.approx(left + lost + stored, rel=1e-9)
    assert stored < 1e-3


@pytest.mark.thorough
def test_the_generator_runs_and_rests_for_its_least_time(cache: Path) -> None:
    bench = Bench(opened(PARTS + "SeriesControl", cache), 1e-6)
    changes, was = [], 0.0
    for k in range(1200):
        # A charge that swings through the whole band every 3 s.
        bench.set({"soc": 0.5 + 0.05 * math.sin(2 * math.pi * k / 30)})
        bench.step(0.1 * k, 0.1)
        now = bench.get(["generator_power_demand"])[0]
        if (now > 0) != (was > 0):
            changes.append(0.1 * (k + 1))
        was = now
    bench.close()
    assert len(changes) >= 4
    assert min(np.diff(changes)) > 19.8


@pytest.mark.thorough
def test_the_operating_point_follows_the_mean_power_with_hysteresis(cache: Path) -> None:
    bench = Bench(opened(PARTS + "SeriesControl", cache), 1e-6)
    bench.set({"soc": 0.4})
    seen = []
    for k, torque in enumerate([0.0, 200.0, 400.0, 200.0, 0.0]):
        bench.set({"torque_demand": torque, "motor_speed": 400.0})
        for step in range(20):
            bench.step(200.0 * k + 10.0 * step, 10.0)
        seen += bench.get(["generator_power_demand"])
    bench.close()
    # 200 N.m at the wheels are 8.3 kW, between 7 and 9 kW where the point stays; 400 are 16.6 kW.
    assert seen == [8e3, 8e3, 22e3, 14e3, 8e3]


@pytest.mark.thorough
def test_the_engine_starts_for_power_and_stops_after_its_least_time(cache: Path) -> None:
    bench = Bench(opened(PARTS + "HybridControl", cache), 1e-6)
    bench.set({"ratio": 10.0, "machine_speed": 200.0, "engine_speed": 0.0, "soc": 0.5})
    engine, clutch = [], []
    for k in range(200):
        now = 0.05 * k
        # 20 kW for one second, then little: it must run on for 4 s since its start.
        bench.set({"torque_demand": 1000.0 if 1 <= now < 2 else 100.0, "engine_speed": 200.0 if now > 1.5 else 0.0})
        bench.step(now, 0.05)
        engine += bench.get(["engine_torque_demand"])
        clutch += bench.get(["clutch"])
    bench.close()
    times = 0.05 * np.arange(1, 201)
    on = times[np.array(engine) > 0]
    assert on[0] == pytest.approx(1.05, abs=0.06)
    assert on[-1] == pytest.approx(5.0, abs=0.11)
    slipping = np.array(clutch)[(times > 1.4) & (times <= 1.5)]
    assert slipping == pytest.approx(0.15, abs=0.01)
    assert np.array(clutch)[(times > 2.2) & (times < 4.8)].min() > 0.99
    assert clutch[-1] < 1e-6


@pytest.mark.thorough
def test_the_engine_stays_off_below_its_speed_however_low_the_battery(cache: Path) -> None:
    inputs = {"ratio": 15.0, "machine_speed": 80.0, "soc": 0.3, "torque_demand": 3000.0}
    engine, clutch, machine = settled(
        cache, "HybridControl", inputs, ("engine_torque_demand", "clutch", "machine_torque_demand"), 5.0
    )
    assert engine == 0
    assert clutch < 1e-9
    assert machine == pytest.approx(200.0)


def test_the_engine_charges_a_low_battery_while_the_wheels_get_what_they_ask(cache: Path) -> None:
    inputs = {"ratio": 10.0, "machine_speed": 200.0, "engine_speed": 200.0, "soc": 0.42, "torque_demand": 500.0}
    engine, machine = settled(cache, "HybridControl", inputs, ("engine_torque_demand", "machine_torque_demand"), 30.0)
    assert engine == pytest.approx(50.0 + 8000.0 / 200.0, rel=1e-4)
    assert engine + machine == pytest.approx(50.0, rel=1e-4)
