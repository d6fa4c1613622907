"""Powertrains and brakes against their closed forms."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

NewPart = Callable[..., Any]
EXACT = 1e-12


@pytest.mark.parametrize("h", [0.01, 0.1])
def test_the_torque_of_a_powertrain_follows_a_step_exponentially(new_part: NewPart, h: float) -> None:
    part = new_part("combustion_ideal", lag=0.5, front_share=0.7)
    part["torque_demand"] = 800.0
    part.init()
    for k in range(1, 31):
        part.step(h)
        torque = 800.0 * (1 - math.exp(-k * h / 0.5))
        assert part["wheels.front"] == pytest.approx(0.7 * torque, rel=EXACT)
        assert part["wheels.rear"] == pytest.approx(0.3 * torque, rel=EXACT)


def test_a_powertrain_without_lag_answers_at_once(new_part: NewPart) -> None:
    part = new_part("bev_ideal", lag=0.0)
    part["torque_demand"] = 500.0
    part.init()
    part.step()
    assert part["wheels.rear"] == 500.0


@pytest.mark.parametrize(
    ("speed", "highest"),
    [(0.0, 2600.0), (90e3 / 2600 - 0.1, 2600.0), (34.7, 90e3 / 34.7), (60.0, 1500.0), (90.0, 1000.0)],
)
def test_torque_is_limited_below_the_corner_and_power_above(new_part: NewPart, speed: float, highest: float) -> None:
    part = new_part("combustion_ideal", max_torque=2600.0, max_power=90e3, lag=0.0)
    part["torque_demand"] = 1e6
    part["wheel_speed.front"] = part["wheel_speed.rear"] = speed
    part.init()
    part.step()
    assert part["wheels.front"] + part["wheels.rear"] == pytest.approx(highest, rel=EXACT)


def test_a_powertrain_does_not_brake(new_part: NewPart) -> None:
    part = new_part("bev_ideal", lag=0.0)
    part["torque_demand"] = -500.0
    part.init()
    part.step()
    assert part["wheels.front"] == part["wheels.rear"] == 0


def test_drawn_power_is_mechanical_power_over_efficiency_plus_what_is_drawn_at_rest(new_part: NewPart) -> None:
    part = new_part("bev_ideal", lag=0.0, front_share=0.25, efficiency=0.8, auxiliary_power=400.0)
    part["torque_demand"] = 1000.0
    part["wheel_speed.front"], part["wheel_speed.rear"] = 40.0, 42.0
    part.init()
    assert part["battery_power"] == 400.0
    part.step()
    assert part["battery_power"] == pytest.approx(400 + (250 * 40 + 750 * 42) / 0.8, rel=EXACT)
    assert part["fuel_power"] == part["co2"] == 0.0


def test_the_exhaust_carries_what_the_drawn_fuel_contains(new_part: NewPart) -> None:
    part = new_part("combustion_ideal", lag=0.0, efficiency=0.3, auxiliary_power=6000.0)
    part["torque_demand"], part["wheel_speed.front"] = 900.0, 30.0
    part.init()
    part.step()
    assert part["fuel_power"] == pytest.approx(6000 + 27e3 / 0.3, rel=EXACT)
    assert part["co2"] == pytest.approx(part["fuel_power"] * 73.4e-9, rel=EXACT)
    assert part["battery_power"] == 0.0


@pytest.mark.parametrize("dead_time", [0.0, 0.08, 0.025, 0.613])
def test_a_brake_builds_up_exponentially_after_its_dead_time(new_part: NewPart, dead_time: float) -> None:
    part = new_part("hydraulic_booster", dead_time=dead_time, lag=0.12, front_share=0.65)
    part.init()
    part["torque_demand"] = 2000.0
    for k in range(1, 150):
        part.step()
        since = k * 0.01 - dead_time
        torque = 2000.0 * (1 - math.exp(-since / 0.12)) if since > 0 else 0.0
        assert part["torque.front"] + part["torque.rear"] == pytest.approx(torque, rel=1e-11, abs=1e-9)
        assert part["torque.front"] == pytest.approx(0.65 * torque, rel=1e-11, abs=1e-9)


def test_a_brake_forgets_nothing_when_its_memory_wraps_around(new_part: NewPart) -> None:
    part = new_part("brake_by_wire", dead_time=0.05, lag=0.0)
    part.init()
    for k in range(500):
        part["torque_demand"] = 10.0 * k
        part.step()
        # The demand of step k acts within step k and is seen after it; five steps later here.
        assert part["torque.front"] + part["torque.rear"] == pytest.approx(max(10.0 * (k - 5), 0), rel=EXACT)


def test_brake_torque_stays_between_zero_and_its_limit(new_part: NewPart) -> None:
    part = new_part("brake_by_wire", dead_time=0.0, lag=0.0)
    part.init()
    for demand, torque in ((-100.0, 0.0), (1e6, 5300.0)):
        part["torque_demand"] = demand
        part.step()
        assert part["torque.front"] + part["torque.rear"] == pytest.approx(torque, rel=EXACT)


def test_brake_power_is_torque_times_wheel_speed_in_either_direction(new_part: NewPart) -> None:
    part = new_part("brake_by_wire", dead_time=0.0, lag=0.0, front_share=0.6)
    part["wheel_speed.front"], part["wheel_speed.rear"] = -20.0, 30.0
    part["torque_demand"] = 1000.0
    part.init()
    assert part["power"] == 0
    part.step()
    assert part["power"] == pytest.approx(600 * 20 + 400 * 30, rel=EXACT)
