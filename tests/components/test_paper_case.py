"""The loop of the paper closed by hand: what the gains are chosen for, without any of the tool around it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

NewPart = Callable[..., Any]
SET_SPEED, SET_GAP = 70 / 3.6, 40.0
WIRES = [
    ("world", "scene.range", "sensor", "scene.range"),
    ("world", "scene.azimuth", "sensor", "scene.azimuth"),
    ("world", "scene.closing_speed", "sensor", "scene.closing_speed"),
    ("world", "scene.hit", "sensor", "scene.hit"),
    ("sensor", "target.gap", "controller", "target.gap"),
    ("sensor", "target.closing_speed", "controller", "target.closing_speed"),
    ("sensor", "target.detected", "controller", "target.detected"),
    ("world", "speed", "controller", "speed"),
    ("controller", "demand.drive_torque", "powertrain", "torque_demand"),
    ("controller", "demand.brake_torque", "brake", "torque_demand"),
    ("world", "wheel_speed.front", "powertrain", "wheel_speed.front"),
    ("world", "wheel_speed.rear", "powertrain", "wheel_speed.rear"),
    ("powertrain", "wheels.front", "world", "wheels.front"),
    ("powertrain", "wheels.rear", "world", "wheels.rear"),
    ("brake", "torque.front", "world", "brake.front"),
    ("brake", "torque.rear", "world", "brake.rear"),
]


def simulate(
    new_part: NewPart,
    sensor: str = "radar_77ghz_mid",
    controller: str = "pd_acc",
    powertrain: str = "combustion_ideal",
    **gains: float,
) -> NDArray[np.float64]:
    """Speed, gap and mode every 10 ms for 60 s; outputs first, then inputs, then steps, as the master does it."""
    parts = {
        "world": new_part("straight_road"),
        "sensor": new_part(sensor, gap_noise=0.0, closing_speed_noise=0.0),
        "controller": new_part(controller, **gains),
        "powertrain": new_part(powertrain),
        "brake": new_part("hydraulic_booster"),
    }
    parts["controller"]["set_speed"], parts["controller"]["set_gap"] = SET_SPEED, SET_GAP
    every = {name: round((part.component.source.step or 0.01) / 0.01) for name, part in parts.items()}
    # The world's outputs at the start depend on no input, so this order settles every initial value.
    for name, part in parts.items():
        for source, output, target, port in WIRES:
            if target == name and name != "world":
                part[port] = parts[source][output]
        part.init()
    rows = []
    wires = [(parts[s].slots[o][1], parts[t].slots[i][1]) for s, o, t, i in WIRES]
    for k in range(6001):
        rows.append((parts["world"]["speed"], parts["world"]["gap"], parts["controller"]["mode"]))
        values = [source.value for source, _ in wires]
        for (_, target), value in zip(wires, values, strict=True):
            target.value = value
        for name, part in parts.items():
            if (k + 1) % every[name] == 0:
                part.step(0.01)
    return np.array(rows)


def test_the_nominal_gains_meet_both_requirements_and_come_to_rest_behind_the_lead(new_part: NewPart) -> None:
    speed, gap, mode = simulate(new_part).T
    assert speed.max() <= SET_SPEED * 1.0005
    assert speed.max() >= SET_SPEED * 0.999  # the set speed is reached before the lead is
    assert gap.min() >= SET_GAP * 0.9999
    assert speed[-1] * 3.6 == pytest.approx(50, abs=0.5)
    assert gap[-1] == pytest.approx(40, abs=0.5)
    # First A falls behind while it accelerates, then it closes in, and the mode changes once.
    assert gap.max() > 190
    assert mode[0] == 0
    assert mode[-1] == 1
    assert np.count_nonzero(np.diff(mode)) == 1


@pytest.mark.parametrize("sensor", ["radar_77ghz_long", "lidar_905nm", "camera_mono"])
def test_the_nominal_gains_suit_every_sensor(new_part: NewPart, sensor: str) -> None:
    speed, gap, _ = simulate(new_part, sensor).T
    assert speed.max() <= SET_SPEED * 1.005
    assert gap.min() >= SET_GAP * 0.99
    assert gap[-1] == pytest.approx(40, abs=0.5)


@pytest.mark.parametrize("powertrain", ["combustion_ideal", "bev_ideal"])
@pytest.mark.parametrize("controller", ["pd_acc", "pi_time_gap_acc", "lq_acc"])
def test_controllers_with_a_fixed_gap_end_behind_the_lead_with_every_powertrain(
    new_part: NewPart, controller: str, powertrain: str
) -> None:
    speed, gap, _ = simulate(new_part, controller=controller, powertrain=powertrain).T
    assert speed.max() <= SET_SPEED * 1.005
    assert gap.min() >= SET_GAP * 0.99
    assert speed[-1] * 3.6 == pytest.approx(50, abs=0.5)
    assert gap[-1] == pytest.approx(40, abs=0.5)


def test_too_little_speed_damping_overshoots_the_set_speed(new_part: NewPart) -> None:
    speed, *_ = simulate(new_part, kp_speed=3.0, kd_speed=0.2).T
    assert speed.max() > SET_SPEED * 1.005


def test_too_little_gap_damping_undershoots_the_set_gap(new_part: NewPart) -> None:
    _, gap, _ = simulate(new_part, kp_gap=0.15, kd_gap=0.4).T
    assert gap.min() < SET_GAP * 0.99


def test_too_much_gap_damping_never_comes_to_the_set_gap(new_part: NewPart) -> None:
    _, gap, _ = simulate(new_part, kp_gap=0.03, kd_gap=1.0).T
    assert gap.min() > SET_GAP * 1.02
