"""The cruise controllers in isolation, against laws written down by hand."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest

NewPart = Callable[..., Any]
T = 0.01
MASS, RADIUS, DRAG_AREA, ROLLING = 1600.0, 0.31, 0.65, 0.01
EXACT = 1e-12


def torque(acceleration: float, speed: float) -> float:
    road_load = 0.5 * 1.2 * DRAG_AREA * speed**2 + (ROLLING * MASS * 9.81 if speed > 0 else 0)
    return RADIUS * (MASS * acceleration + road_load)


def net_demand(part: Any) -> float:
    assert part["demand.drive_torque"] >= 0
    assert part["demand.brake_torque"] >= 0
    assert part["demand.drive_torque"] == 0 or part["demand.brake_torque"] == 0
    return float(part["demand.drive_torque"] - part["demand.brake_torque"])


def drive(part: Any, speed: float, gap: float, closing_speed: float, detected: bool) -> None:
    part["speed"] = speed
    part["target.gap"] = gap
    part["target.closing_speed"] = closing_speed
    part["target.detected"] = detected


def course() -> Iterator[tuple[float, float, float, bool]]:
    """A drive that meets both modes and both limits: speed, gap, closing speed, detected."""
    for k in range(600):
        t = k * T
        speed = 10 + 11 * math.sin(0.9 * t) ** 2
        yield speed, 120 - 18 * t + 3 * math.sin(2 * t), 18 - 6 * math.cos(2 * t), 1.0 < t < 5.5


def test_pd_acc_equals_its_recursion_step_by_step(new_part: NewPart) -> None:
    kps, kds, kpg, kdg = 0.9, 0.4, 0.11, 0.6
    part = new_part("pd_acc", kp_speed=kps, kd_speed=kds, kp_gap=kpg, kd_gap=kdg)
    part["set_speed"], part["set_gap"] = 20.0, 40.0
    drive(part, *next(course()))
    part.init()
    modes, accelerations = set(), []
    previous = 20.0 - next(course())[0]
    for speed, gap, closing, detected in course():
        drive(part, speed, gap, closing, detected)
        part.step()
        error = 20.0 - speed
        wanted = min(max(kps * error + kds * (error - previous) / T, -3.5), 2.0)
        previous = error
        mode = 0
        if detected:
            following = min(max(kpg * (gap - 40.0) - kdg * closing, -3.5), 2.0)
            if following < wanted:
                wanted, mode = following, 1
        assert net_demand(part) == pytest.approx(torque(wanted, speed), rel=EXACT, abs=1e-9)
        assert part["mode"] == mode
        assert part["reference.speed"] == pytest.approx(speed - closing if mode else 20.0, rel=EXACT)
        assert part["reference.gap"] == 40.0
        modes.add(mode)
        accelerations.append(wanted)
    assert modes == {0, 1}
    assert min(accelerations) == -3.5
    assert max(accelerations) == 2.0
    assert any(-3.5 < a < 2.0 for a in accelerations)


def test_pd_acc_answers_a_step_of_the_set_speed_with_one_kick_of_the_derivative(new_part: NewPart) -> None:
    part = new_part("pd_acc", kp_speed=0.5, kd_speed=0.004, max_acceleration=5.0)
    part["speed"], part["set_speed"] = 20.0, 20.0
    part.init()
    assert net_demand(part) == pytest.approx(torque(0, 20), rel=EXACT)
    part["set_speed"] = 22.0
    part.step()
    assert net_demand(part) == pytest.approx(torque(0.5 * 2 + 0.004 * 2 / T, 20), rel=EXACT)
    part.step()
    assert net_demand(part) == pytest.approx(torque(0.5 * 2, 20), rel=EXACT)


def test_full_acceleration_towards_a_far_target_stays_in_speed_mode(new_part: NewPart) -> None:
    part = new_part("pd_acc")
    part["set_speed"], part["set_gap"] = 70 / 3.6, 40.0
    drive(part, 0.0, 150.0, -50 / 3.6, True)
    part.init()
    assert part["mode"] == 0
    assert net_demand(part) == pytest.approx(torque(2.0, 0), rel=EXACT)


@pytest.mark.parametrize("name", ["pd_acc", "pi_time_gap_acc", "idm_acc", "lq_acc"])
@pytest.mark.parametrize(
    ("setting", "wanted"), [("fixed", 40.0), ("long", 4 + 2 * 25), ("middle", 4 + 1.5 * 25), ("short", 4 + 25)]
)
def test_the_gap_setting_chooses_a_fixed_gap_or_a_time_gap(
    new_part: NewPart, name: str, setting: str, wanted: float
) -> None:
    part = new_part(name, gap_setting=setting)
    part["speed"], part["set_speed"], part["set_gap"] = 25.0, 30.0, 40.0
    part.init()
    assert part["reference.gap"] == pytest.approx(wanted, rel=EXACT)


@pytest.mark.parametrize("name", ["pd_acc", "pi_time_gap_acc", "lq_acc"])
def test_at_the_wanted_gap_and_the_leads_speed_only_the_road_load_is_asked_for(new_part: NewPart, name: str) -> None:
    part = new_part(name)
    part["set_speed"], part["set_gap"] = 70 / 3.6, 40.0
    drive(part, 50 / 3.6, 40.0, 0.0, True)
    part.init()
    part.step()
    assert part["mode"] == 1
    assert net_demand(part) == pytest.approx(torque(0, 50 / 3.6), rel=EXACT)
    assert part["reference.speed"] == pytest.approx(50 / 3.6, rel=EXACT)


def test_idm_acc_is_in_equilibrium_at_the_gap_of_the_closed_form(new_part: NewPart) -> None:
    part = new_part("idm_acc", gap_setting="middle")
    v, v0 = 50 / 3.6, 70 / 3.6
    part["set_speed"] = v0
    gap = (4 + 1.5 * v) / math.sqrt(1 - (v / v0) ** 4)
    drive(part, v, gap, 0.0, True)
    part.init()
    # The acceleration is a difference of ones, so it is zero to within rounding, not relative to itself.
    assert net_demand(part) == pytest.approx(torque(0, v), rel=1e-11)
    assert part["mode"] == 1
    drive(part, v, gap + 1, 0.0, True)
    part.step()
    assert net_demand(part) > torque(0, v)
    drive(part, v, gap - 1, 0.0, True)
    part.step()
    assert net_demand(part) < torque(0, v)


def test_idm_acc_brakes_as_the_model_says_when_it_closes_in(new_part: NewPart) -> None:
    part = new_part("idm_acc", max_deceleration=10.0)
    part["set_speed"], part["set_gap"] = 30.0, 20.0
    drive(part, 20.0, 60.0, 3.0, True)
    part.init()
    desired = 20.0 + 20.0 * 3.0 / (2 * math.sqrt(2.0 * 1.67))
    wanted = 2.0 * (1 - (20 / 30) ** 4 - (desired / 60) ** 2)
    assert net_demand(part) == pytest.approx(torque(wanted, 20.0), rel=EXACT)


@pytest.mark.parametrize("gap", [0.0, -1.0])
def test_idm_acc_brakes_fully_when_there_is_no_gap_left(new_part: NewPart, gap: float) -> None:
    part = new_part("idm_acc")
    part["set_speed"], part["set_gap"] = 30.0, 20.0
    drive(part, 20.0, gap, 3.0, True)
    part.init()
    assert net_demand(part) == pytest.approx(torque(-3.5, 20.0), rel=EXACT)


def test_pi_acc_leaves_its_limit_as_soon_as_the_error_changes_sign(new_part: NewPart) -> None:
    part = new_part("pi_time_gap_acc", ki_speed=0.5)
    part["speed"], part["set_speed"] = 10.0, 30.0
    part.init()
    for _ in range(2000):
        part.step()
    assert net_demand(part) == pytest.approx(torque(2.0, 10.0), rel=EXACT)
    part["speed"] = 30.0
    part.step()
    # Nothing was summed up at the limit: without an error there is no demand but the road load.
    assert net_demand(part) == pytest.approx(torque(0, 30.0), rel=EXACT)


def test_pi_acc_sums_up_its_error_inside_the_limits(new_part: NewPart) -> None:
    part = new_part("pi_time_gap_acc", kp_speed=0.5, ki_speed=0.1)
    part["speed"], part["set_speed"] = 20.0, 21.0
    part.init()
    for _ in range(300):
        part.step()
    assert net_demand(part) == pytest.approx(torque(0.5 + 0.1 * 3.0, 20.0), rel=1e-11)


def test_pi_acc_turns_the_gap_into_a_speed_and_feeds_its_slope_forward(new_part: NewPart) -> None:
    part = new_part("pi_time_gap_acc", kp_speed=0.5, ki_speed=0.1, k_gap=0.2)
    part["set_speed"], part["set_gap"] = 30.0, 40.0
    drive(part, 16.0, 50.0, 1.5, True)
    part.init()
    error = (16.0 - 1.5 + 0.2 * (50.0 - 40.0)) - 16.0
    assert net_demand(part) == pytest.approx(torque(0.5 * error - 0.2 * 1.5, 16.0), rel=EXACT)
    assert part["mode"] == 1
    part.step()
    assert net_demand(part) == pytest.approx(torque(0.5 * error - 0.2 * 1.5 + 0.1 * error * T, 16.0), rel=EXACT)
