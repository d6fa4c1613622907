"""Shifts with two phases, charger, temperatures and ageing against closed forms and scipy."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from bench import Bench, opened, run
from combustion import Petrol
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.linalg import expm

PARTS = "AdasPowertrain.Parts."
TORQUE_PHASE, INERTIA_PHASE, INERTIA = 0.15, 0.3, 0.17
SECOND, THIRD = 2.273, 1.531


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Path:
    return built_before(tmp_path_factory.mktemp("fidelity"))


@pytest.mark.sampled(12)
@pytest.mark.parametrize("share", [0.0, 0.6, 1.0])
@pytest.mark.parametrize(
    ("torque", "speed", "seen", "torque_first"),
    [(100.0, 80.0, 90.0, True), (100.0, 100.0, 60.0, False), (-60.0, 80.0, 90.0, False), (-60.0, 100.0, 60.0, True)],
    ids=["driving up", "driving down", "overrun up", "overrun down"],
)
@pytest.mark.thorough
def test_a_shift_has_the_heat_duration_and_torque_hole_of_the_closed_form(
    torque: float, speed: float, seen: float, torque_first: bool, share: float, cache: Path
) -> None:
    """Output speed and engine torque constant. Heat: torque, and the inertia's share of it, times mean slip.

    The car's inertia of 1e8 kg.m2 gains less than 1e-5 rad/s; the tolerances are ten times that.
    """
    names = ("speed", "output_torque", "heat", "work", "given", "kinetic")
    times = np.arange(0.0, 2.0, 0.01)
    starts = {"torque": torque, "output_speed": speed, "seen": seen, "intervention_share": share}
    found = run(opened("Fidelity.ShiftBench", cache), names, times, 1e-9, starts)
    is_up = seen > speed
    old, new = (SECOND, THIRD) if is_up else (THIRD, SECOND)
    apart, inertia_begins = (old - new) * speed, 1 + (TORQUE_PHASE if torque_first else 0)
    torque_begins = 1 + (0 if torque_first else INERTIA_PHASE)
    progress = np.clip((times - inertia_begins) / INERTIA_PHASE, 0, 1)
    assert found[:, 0] == pytest.approx(speed * old - apart * progress**2 * (3 - 2 * progress), abs=1e-4)
    taken = share * INERTIA * apart * 6 * progress * (1 - progress) / INERTIA_PHASE if is_up else 0 * times
    into = torque - taken + INERTIA * apart * 6 * progress * (1 - progress) / INERTIA_PHASE
    handed = np.clip((times - torque_begins) / TORQUE_PHASE, 0, 1)
    assert found[:, 1] == pytest.approx(into * (old + (new - old) * handed), abs=1e-3)
    heat = abs(torque * apart) * (TORQUE_PHASE + INERTIA_PHASE) / 2
    inertial = 0.5 * INERTIA * apart**2 * (1 if torque_first else -1) * (1 - share if is_up else 1)
    assert found[-1, 2] == pytest.approx(heat + inertial, rel=1e-6)
    balance = found[:, 3] - found[:, 2] - found[:, 4] - (found[:, 5] - found[0, 5])
    assert np.abs(balance).max() < 1e-8 * np.abs(found[:, 3]).max()
    if is_up and torque > 0:  # the hole is the ratio of the gears; with full intervention, nothing sticks out above it
        assert found[:, 1].min() == pytest.approx(torque * new, rel=1e-6)
        if share == 1:
            assert found[times > 1.15, 1] == pytest.approx(torque * new, rel=1e-6)


@pytest.mark.thorough
@pytest.mark.parametrize("asked", [0.0, 40.0])
def test_a_charged_engine_with_manifold_follows_scipy_and_keeps_its_energy(asked: float, cache: Path) -> None:
    petrol, speed = Petrol(auxiliary_power=0.0), 157.0
    natural, full, drag = 13e5 * 1.498e-3 / (4 * math.pi), petrol.highest(speed), petrol.drag(speed)
    times = np.linspace(0.0, 5.0, 101)
    names = ("boost", "torque", "burned", "lost", "work")
    found = run(opened("Fidelity.TurboBench", cache), names, times, 1e-9, {"asked": asked})

    def derivative(t: float, y: np.ndarray) -> list[float]:
        wanted = petrol.wanted(speed, 20.0 if t < 1 else 400.0)
        available = min(full, natural * y[0] + petrol.throttling(speed))
        target = 0.5 * (available + wanted - math.hypot(available - wanted, 2.0))
        flow = max(0.005, petrol.fuel(speed, max(0.0, y[1])) / 43.2e6 * 15.6)
        charge = min(wanted, full) - petrol.throttling(speed)
        return [(max(1.0, charge / natural) - y[0]) * flow / 0.02, (target - y[1]) / 0.06]

    first = solve_ivp(derivative, (0, 1), [1.0, 0.0], "DOP853", times[:21], rtol=1e-11, atol=1e-11).y
    then = solve_ivp(derivative, (1, 5), first[:, -1], "DOP853", times[20:], rtol=1e-11, atol=1e-11, max_step=0.01).y
    boost, air = np.hstack([first, then[:, 1:]])
    assert np.abs(found[:, 0] / 1.013e5 - boost).max() < 1e-6
    charge = found[:, 1] + drag - petrol.throttling(speed)
    if asked == 0:  # 90 % of the torque of the charge are there 1.1 s after the demand
        assert times[charge > 0.9 * (full - petrol.throttling(speed))][0] == pytest.approx(2.1, abs=0.06)
    ignited = np.maximum(0.3 * air, air - asked)
    assert np.abs(found[:, 1] - (ignited - drag)).max() < 1e-4
    assert np.abs(found[:, 2] - found[:, 3] - found[:, 4]).max() < 1e-9 * found[-1, 2]


@pytest.mark.sampled(5)
@pytest.mark.parametrize(("rate", "factor"), [(0.5, 31630), (2.0, 21681), (6.0, 12934), (10.0, 15512), (25.0, 15512)])
def test_capacity_is_lost_as_published(rate: float, factor: float, cache: Path) -> None:
    """Wang 2011 and Naumann 2018 as printed, half an hour each at 25 and 40 degrees, damage added up along each law."""
    found = run(
        opened("Fidelity.AgeingBench", cache), ("cycle_loss", "calendar_loss", "state_of_health"),
        np.linspace(0, 3600, 3), 1e-10, {"c_rate": rate},
    )  # fmt: skip
    counted, damage, squared = min(rate, 10.0), 0.01 ** (1 / 0.55) * 100 ** (1 / 0.55), 0.02**2
    for kelvin, row in ((298.15, found[1]), (313.15, found[2])):
        severity = factor * math.exp((370.3 * counted - 31700) / (8.314 * kelvin))
        damage += severity ** (1 / 0.55) * 1000 * 0.5 * rate * 2.2
        by_time = 1.2571e-5 * math.exp(-17126 / 8.314 * (1 / kelvin - 1 / 298.15)) * 0.60225
        squared += by_time**2 * 87600 * 1800
        assert row == pytest.approx(
            [0.01 * damage**0.55, math.sqrt(squared), 1 - 0.01 * damage**0.55 - math.sqrt(squared)], rel=1e-7
        )


@pytest.mark.thorough
@pytest.mark.parametrize("power", [20e3, -15e3])
def test_the_battery_with_temperature_is_its_circuit_and_its_heat_balance(power: float, cache: Path) -> None:
    """From -7 degrees, 0.1 of the charge: resistances change by a factor; 200 W come from the coolant."""
    cells, capacity, start = 96, 28800.0, 0.4 if power > 0 else 0.1
    volts = (2.0845, 2.4996, 2.7971, 2.9798, 3.1668, 3.2035, 3.2503, 3.2647, 3.2678, 3.2721, 3.3074, 3.3136, 3.3402)
    curve = PchipInterpolator((0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1), volts)
    specific, times = 0.12 * np.array([227.8, 142.9, 152.5]), np.array([32.85, 223.0])
    capacitances = times * capacity / (specific[1:] * cells)
    heat_capacity = 8.44e-3 * cells * capacity

    def flows(y: np.ndarray) -> tuple[float, float, np.ndarray]:
        soc, kelvin = y[0] / capacity, y[3]
        rise = 1 + np.array([2.0978, 6.8709, 132.48]) * np.exp(-np.array([24.37, 29.14, 155.2]) * soc)
        ohms = specific * cells / capacity * rise * math.exp(20e3 / 8.314 * (1 / kelvin - 1 / 298.15))
        inner = cells * float(curve(soc)) - y[1] - y[2]
        asked = power + 350
        current = 2 * asked / (inner + math.sqrt(inner**2 - 4 * ohms[0] * asked))
        loss = ohms[0] * current**2 + y[1] ** 2 / ohms[1] + y[2] ** 2 / ohms[2]
        return current, loss, ohms

    def derivative(t: float, y: np.ndarray) -> list[float]:
        current, loss, ohms = flows(y)
        warming = (loss + 200 - 4 * (y[3] - 266.15)) / heat_capacity
        return [-current, *((current - y[1:3] / ohms[1:]) / capacitances), warming, 4 * (y[3] - 266.15)]

    inputs = {"electric_power": power, "heat_flow": 200.0}
    starts = {"initial_soc": start, "ambient": 266.15, "initial_temperature": 266.15, "resistance_share": 0.12}
    bench = Bench(opened(PARTS + "ThermalBattery", cache), 1e-10, starts | {"capacity": capacity} | inputs)
    rows = []
    for k in range(12):
        bench.step(10.0 * k, 10.0)
        rows.append(bench.get(["soc", "temperature", "energy_in", "energy_out", "energy_loss", "energy_stored"]))
    state = bench.get(["state_of_health"])[0]
    bench.close()
    found = np.array(rows)
    exact = solve_ivp(
        derivative, (0, 120), [start * capacity, 0, 0, 266.15, 0], "DOP853", np.linspace(0, 120, 13),
        rtol=1e-11, atol=1e-9, max_step=0.5,
    ).y[:, 1:]  # fmt: skip
    assert np.abs(found[:, 0] - exact[0] / capacity).max() < 1e-7
    assert np.abs(found[:, 1] - exact[3]).max() < 1e-5
    entered, left, lost, stored = found[:, 2:].T
    assert np.abs(entered - left - lost - stored).max() < 1e-7 * abs(entered[-1])
    heat = heat_capacity * (found[-1, 1] - 266.15) + exact[4, -1] - 200 * 120
    assert heat == pytest.approx(lost[-1] - 350 * 120, rel=1e-6)  # of the losses, all but the auxiliaries' heat it
    assert 0.99 < state < 1


@pytest.mark.thorough
def test_the_machine_heats_along_an_exponential_and_loses_torque_when_it_is_hot(cache: Path) -> None:
    """Torque and speed constant: losses are linear in the temperature, which is then an exponential."""
    inputs = {"torque_demand": 200.0, "shaft_speed": 150.0, "voltage": 350.0, "heat_flow": -300.0}
    bench = Bench(opened(PARTS + "ThermalMachine", cache), 1e-10, inputs)
    bench.step(0.0, 2.0)
    start, torque = bench.get(["temperature", "torque"])
    current = 200 / (1.5 * 8 * 0.05)
    slope = 1.5 * 0.010 * current**2 * 0.00393 / (1 + 0.00393 * 80)

    def losses() -> float:
        power, given = bench.get(["electric_power", "torque"])
        return float(power - given * 150.0)

    decay = (5 - slope) / 20e3
    settled = start + (losses() - 300 - 5 * (start - 296.15)) / (5 - slope)
    bench.step(2.0, 300.0)
    assert torque == pytest.approx(200, abs=1e-6)
    assert bench.get(["temperature"])[0] == pytest.approx(
        settled + (start - settled) * math.exp(-300 * decay), abs=1e-4
    )
    entered, left, lost = bench.get(["energy_in", "energy_out", "energy_loss"])
    assert entered == pytest.approx(left + lost, rel=1e-9)
    bench.set({"heat_flow": 20e3})
    now = 302.0
    while bench.get(["temperature"])[0] < 433.15:
        bench.step(now, 0.5)
        now += 0.5
        assert now < 600
    bench.set({"torque_demand": 400.0})
    bench.step(now, 0.2)
    kelvin, limited = bench.get(["temperature", "torque"])
    bench.close()
    assert limited == pytest.approx(330 * (443.15 - kelvin) / 20, rel=0.02)  # the lag of the torque


@pytest.mark.thorough
def test_engine_machine_and_battery_share_a_coolant_circuit(cache: Path) -> None:
    """While thermostat and valve rest: the matrix exponential. Afterwards: the heat of all is where it should be."""
    names = tuple(f"{part}.temperature" for part in ("engine", "machine", "battery", "circuit"))
    times = np.linspace(0.0, 3600.0, 121)
    found = run(opened("Fidelity.CircuitBench", cache), (*names, "radiated", "by_air"), times, 1e-9)
    capacities, to_air, to_coolant = [65e3, 20e3, 15e3, 15e3], [15, 5, 4, 0], [30, 150, 80]
    matrix = np.zeros((5, 5))
    for k in range(3):
        matrix[k, [k, 3]] = -(to_air[k] + to_coolant[k]), to_coolant[k]
        matrix[3, [k, 3]] += to_coolant[k], -to_coolant[k]
    matrix[:3, 4] = 8000, 900, 300
    matrix[:4] /= np.array(capacities)[:, None]
    cold = found[:, 3] < 298.15
    assert 10 < cold.sum() < 100
    for time, row in zip(times[cold], found[cold], strict=True):
        assert row[:4] - 263.15 == pytest.approx((expm(matrix * time) @ [0, 0, 0, 0, 1])[:4], abs=1e-5)
    stored = (found[:, :4] - 263.15) @ capacities
    assert stored + found[:, 4] + found[:, 5] == pytest.approx(9200 * times, abs=1e-6 * 9200 * 3600)
    assert found[-1, 3] < 303.15
