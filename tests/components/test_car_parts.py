"""The parts of the electric car against their closed forms."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

NewPart = Callable[..., Any]
EXACT = 1e-12
H = 0.01


def settled(part: Any, **inputs: float) -> Any:
    """*part* after its start, with inputs by name, two underscores for a dot."""
    for name, value in inputs.items():
        part[name.replace("__", ".")] = value
    part.init()
    return part


def test_a_part_stands_on_both_axles_with_its_mass_and_turns_with_four_wheels(new_part: NewPart) -> None:
    part = settled(new_part("wheel_alloy_17", mass=40.0, front_share=0.3, wheel_inertia=0.5, drag=-0.01))
    part.step()
    assert (part["load.front"], part["load.rear"]) == (12.0, 28.0)
    assert (part["inertia.front"], part["inertia.rear"]) == (1.0, 1.0)
    assert part["drag_area"] == -0.01


@pytest.mark.parametrize("power", [-60e3, 0.0, 5e3, 120e3])
def test_a_battery_gives_the_power_at_its_cables_and_heats_its_resistance(new_part: NewPart, power: float) -> None:
    pack = new_part("nmc_77kwh", voltage=350.0, voltage_rise=60.0, resistance=0.05, initial_soc=0.75)
    pack["auxiliary_power"] = 300.0
    settled(pack, drive_power=power - 1000.0, climate_power=700.0)
    current = (350.0 + 60.0 * 0.25 - pack["supply.voltage"]) / 0.05
    # The current is a difference of near voltages here, not in the component.
    assert pack["supply.voltage"] * current == pytest.approx(power, rel=1e-9, abs=1e-6)
    assert pack["battery_power"] == pytest.approx(power + 0.05 * current**2, rel=1e-9, abs=1e-6)


def test_a_battery_without_a_slope_is_drained_by_its_current(new_part: NewPart) -> None:
    pack = new_part("lfp_52kwh", voltage=352.0, voltage_rise=0.0, capacity=100 * 3600.0, initial_soc=0.9)
    pack["resistance"], pack["auxiliary_power"] = 0.08, 0.0
    settled(pack, drive_power=30e3)
    for _ in range(6000):
        pack.step(H)
    current = (352.0 - math.sqrt(352.0**2 - 4 * 0.08 * 30e3)) / (2 * 0.08)
    assert pack["soc"] == pytest.approx(0.9 - current * 60 / (100 * 3600), rel=1e-10)  # 6000 sums


def test_more_than_a_battery_can_give_is_the_most_it_gives(new_part: NewPart) -> None:
    pack = new_part("lfp_52kwh", voltage=352.0, voltage_rise=0.0, resistance=0.08)
    settled(pack, drive_power=1e6)
    assert pack["supply.voltage"] == pytest.approx(176.0, rel=EXACT)
    assert pack["supply.discharge_limit"] == 125e3


@pytest.mark.parametrize(("soc", "limits"), [(0.0, (0.0, 70e3)), (0.5, (125e3, 70e3)), (1.0, (125e3, 0.0))])
def test_an_empty_battery_gives_nothing_and_a_full_one_takes_nothing(
    new_part: NewPart, soc: float, limits: tuple[float, float]
) -> None:
    pack = settled(new_part("lfp_52kwh", initial_soc=soc))
    assert (pack["supply.discharge_limit"], pack["supply.charge_limit"]) == limits


def machine(new_part: NewPart, **parameters: float) -> Any:
    """At rest behind a gear of 10 and 96 %, an inverter of 400 A and 400 V."""
    part = new_part("pmsm_115kw", lag=0.0, **parameters)
    for name, value in (("gear.ratio", 10.0), ("gear.efficiency", 0.96), ("gear.mass", 25.0)):
        part[name] = value
    for name, value in (("max_current", 400.0), ("standby_power", 50.0), ("loss", 0.02), ("mass", 8.0)):
        part[f"inverter.{name}"] = value
    part["voltage"] = 400.0
    return part


def given(part: Any, demand: float, wheel_speed: float) -> Any:
    settled(part, torque_demand=demand, wheel_speed=wheel_speed)
    part.step()
    return part


CURRENT_POWER = math.sqrt(1.5) * 400 * 100 * 0.9
"""W: 100 A at 400 V and a power factor of 0.9."""


@pytest.mark.parametrize(
    ("limits", "current", "wheel_speed", "torque"),
    [
        ({}, 400.0, 10.0, 0.58 * 400),  # the inverter's current
        ({"torque_per_current": 2.0}, 400.0, 10.0, 255.0),  # the machine's torque
        ({}, 400.0, 100.0, 115e3 / 1000),  # its power
        ({"rated_voltage": 500.0}, 400.0, 100.0, 0.8 * 115e3 / 1000),  # less voltage than it was made for
        ({"torque_per_current": 2.0}, 100.0, 100.0, CURRENT_POWER / 1000),  # power of the inverter
        ({}, 400.0, 168.0, 0.0),  # faster than it may turn
    ],
)
def test_the_torque_of_a_machine_is_limited(
    new_part: NewPart, limits: dict[str, float], current: float, wheel_speed: float, torque: float
) -> None:
    part = machine(new_part, **limits)
    part["inverter.max_current"] = current
    given(part, 1e6, wheel_speed)
    assert part["unit.torque"] == pytest.approx(torque * 10 * 0.96, rel=EXACT)
    assert part["unit.regeneration"] == pytest.approx(torque * 10 / 0.96, rel=EXACT)
    given(part, -1e6, wheel_speed)
    assert part["unit.torque"] == pytest.approx(-torque * 10 / 0.96, rel=EXACT)


@pytest.mark.parametrize("demand", [960.0, -500.0])
def test_a_machine_draws_what_it_gives_and_its_losses(new_part: NewPart, demand: float) -> None:
    part = given(machine(new_part, copper=0.06, iron=0.8, windage=1e-7, idle=60.0), demand, 60.0)
    torque = demand / 9.6 if demand > 0 else demand * 0.096
    phases = torque * 600 + 0.06 * torque**2 + 0.8 * 600 + 1e-7 * 600**3 + 60
    assert part["unit.torque"] == pytest.approx(demand, rel=EXACT)
    assert part["unit.electric_power"] == pytest.approx(phases + 0.02 * abs(phases) + 50, rel=EXACT)


def test_a_machine_follows_a_step_exponentially_and_its_rotor_weighs_by_the_ratio_squared(new_part: NewPart) -> None:
    part = machine(new_part)
    part["lag"] = 0.03
    settled(part, torque_demand=960.0, wheel_speed=10.0)
    for k in range(1, 21):
        part.step(H)
        assert part["unit.torque"] == pytest.approx(960 * (1 - math.exp(-k * H / 0.03)), rel=EXACT)
    assert part["unit.inertia"] == pytest.approx(0.042 * 100, rel=EXACT)
    assert part["unit.mass"] == 51.0 + 25.0 + 8.0


def test_a_drive_on_both_axles_splits_demands_and_adds_up(new_part: NewPart) -> None:
    part = new_part("both_axles_control", front_share=0.4, front_regeneration=0.6, mass=16.0)
    for axle, mass in (("front", 60.0), ("rear", 100.0)):
        for name, value in (("mass", mass), ("torque", mass), ("electric_power", 2 * mass), ("inertia", mass / 10)):
            part[f"units.{axle}.{name}"] = value
        part[f"units.{axle}.regeneration"] = 900.0
    part["supply.discharge_limit"] = part["supply.charge_limit"] = 1e6
    settled(part, torque_demand=1000.0, regeneration_demand=200.0)
    assert part["demands.front"] == pytest.approx(400.0 - 120.0, rel=EXACT)
    assert part["demands.rear"] == pytest.approx(600.0 - 80.0, rel=EXACT)
    assert part["regeneration"] == pytest.approx(900 / 0.6, rel=EXACT)  # the front machine has most to do
    assert (part["wheels.front"], part["wheels.rear"], part["electric_power"]) == (60.0, 100.0, 320.0)
    assert part["load.front"] + part["load.rear"] == pytest.approx(60 + 100 + 16, rel=EXACT)
    assert part["load.front"] == pytest.approx(60 + 16 * 60 / 160, rel=EXACT)
    assert (part["inertia.front"], part["inertia.rear"]) == (6.0, 10.0)


@pytest.mark.parametrize(("name", "axle", "other"), [("front_axle_control", 0, 1), ("rear_axle_control", 1, 0)])
def test_a_drive_on_one_axle_has_its_mass_and_torque_there(new_part: NewPart, name: str, axle: int, other: int) -> None:
    part = new_part(name, mass=6.0)
    part["unit.mass"], part["unit.torque"], part["unit.regeneration"] = 84.0, 500.0, 700.0
    part["supply.discharge_limit"] = part["supply.charge_limit"] = 85e3
    settled(part, torque_demand=9e3, wheel_speed__front=20.0 if axle == 0 else 30.0, wheel_speed__rear=30.0 - 10 * axle)
    loads, torques = (part["load.front"], part["load.rear"]), (part["wheels.front"], part["wheels.rear"])
    assert (loads[axle], loads[other], torques[axle], torques[other]) == (90.0, 0.0, 500.0, 0.0)
    assert part["demand"] == pytest.approx(0.85 * 85e3 / 20, rel=EXACT)  # of 9 kN.m, by what the battery gives
    assert part["regeneration"] == 700.0


@pytest.mark.parametrize(
    ("speed", "machines"), [(0.0, 0.0), (5 / 3.6, 0.0), (8.5 / 3.6, 400.0), (12 / 3.6, 800.0), (30.0, 800.0)]
)
def test_machines_brake_first_and_less_below_walking_speed(new_part: NewPart, speed: float, machines: float) -> None:
    part = settled(new_part("blended_braking"), brake_demand=1500.0, regeneration=800.0, speed=speed)
    assert part["regeneration_demand"] == pytest.approx(machines, rel=EXACT)
    assert part["friction_demand"] == pytest.approx(1500 - machines, rel=EXACT)
    assert settled(part, brake_demand=300.0, speed=30.0)["friction_demand"] == 0
    alone = settled(new_part("separate_braking"), brake_demand=1500.0, regeneration=800.0, speed=speed)
    assert (alone["regeneration_demand"], alone["friction_demand"]) == (0.0, 1500.0)


LOADS = {"body": (500, 450), "aero": (9, 6), "tyres": (19, 19), "wheels": (18, 18), "discs": (27, 20)} | {
    "climate": (20, 2),
    "battery": (210, 226),
    "drive": (0, 96),
}


def car(new_part: NewPart, **parameters: float) -> Any:
    part = new_part("car_on_road", payload=150.0, payload_front_share=0.4, **parameters)
    for name, (front, rear) in LOADS.items():
        part[f"loads.{name}.front"], part[f"loads.{name}.rear"] = float(front), float(rear)
    for number, name in enumerate(("tyres", "wheels", "discs", "drive")):
        part[f"inertias.{name}.front"], part[f"inertias.{name}.rear"] = 0.5, 0.5 + number
    part["drag_areas.aero"], part["drag_areas.wheels"] = 0.6, -0.01
    for name, value in (("radius", 0.32), ("grip", 0.95), ("stiffness", 21.0), ("rolling_resistance", 0.008)):
        part[f"tyre.{name}"] = value
    return part


def test_a_car_of_parts_moves_as_the_straight_road_with_the_sums_of_its_parts(new_part: NewPart) -> None:
    scenario = {"initial_speed": 15.0, "grade": 0.03, "cg_height": 0.5, "wheelbase": 2.8, "lead_change_rate": 2.0}
    assembled = car(new_part, surface=0.6, **scenario)
    front = sum(f for f, _ in LOADS.values()) + 60
    mass = front + sum(r for _, r in LOADS.values()) + 90
    plain = new_part("straight_road", mass=mass, front_load_share=front / mass, drag_area=0.59, wheel_radius=0.32)
    sums = {"inertia_front": 2.0, "inertia_rear": 8.0, "friction": 0.6 * 0.95, "slip_stiffness": 21.0}
    for name, value in {**scenario, **sums, "rolling_resistance": 0.008}.items():
        plain[name] = value
    for part in (assembled, plain):
        settled(part, wheels__front=200.0, wheels__rear=900.0, brake__front=50.0)
    assert (assembled["mass"], assembled["front_share"]) == (mass, front / mass)
    for _ in range(500):
        assembled.step(H)
        plain.step(H)
        for name in ("speed", "position", "acceleration", "gap", "wheel_speed.rear", "lead.speed", "scene.range"):
            assert assembled[name] == pytest.approx(plain[name], rel=EXACT)


def test_the_jerk_is_that_of_the_acceleration_behind_a_low_pass_of_a_second(new_part: NewPart) -> None:
    part = settled(car(new_part, initial_speed=20.0), wheels__rear=800.0)
    smooth = part["acceleration"]
    for _ in range(300):
        part.step(H)
        smooth += (part["acceleration"] - smooth) * (1 - math.exp(-H))
        assert part["jerk"] == pytest.approx(part["acceleration"] - smooth, abs=1e-12)
