"""Who is heard of those who drive and brake."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

NewPart = Callable[..., Any]


def driven(part: Any, drive: float, brake: float, emergency: float = 0.0, yielding: float = 0.0) -> tuple[float, float]:
    part["demand.drive_torque"], part["demand.brake_torque"] = drive, brake
    part["emergency_torque"], part["yielding_torque"] = emergency, yielding
    part.step()
    return part["drive_torque"], part["brake_torque"]


def test_the_cruise_control_is_heard_while_nobody_else_brakes(new_part: NewPart) -> None:
    part = new_part("highest_brake")
    part.init()
    assert driven(part, 700.0, 0.0) == (700.0, 0.0)
    assert driven(part, 0.0, 300.0) == (0.0, 300.0)


@pytest.mark.parametrize(("emergency", "yielding"), [(2000.0, 0.0), (0.0, 2000.0), (2000.0, 900.0)])
def test_the_highest_demand_brakes_and_cuts_the_drive(new_part: NewPart, emergency: float, yielding: float) -> None:
    part = new_part("highest_brake")
    part.init()
    assert driven(part, 700.0, 0.0, emergency, yielding) == (0.0, 2000.0)
    assert driven(part, 700.0, 2500.0, emergency, yielding) == (0.0, 2500.0)


def test_the_drive_comes_back_with_its_rate_then_follows_at_once(new_part: NewPart) -> None:
    part = new_part("highest_brake", drive_rate=2000.0)
    part.init()
    driven(part, 50.0, 0.0, 1000.0)
    assert [driven(part, 50.0, 0.0)[0] for _ in range(4)] == pytest.approx([20.0, 40.0, 50.0, 50.0], rel=1e-12)
    assert driven(part, 500.0, 0.0) == (500.0, 0.0)
