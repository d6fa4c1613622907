"""Who has the car: the driver first, the assistance as long as it is wanted, the emergency brake above all."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from components.conftest import WORKSPACE, Shelf
from hypothesis import given, settings, strategies as st

NewPart = Callable[..., Any]
MANUAL, STANDBY, CRUISE, OVERRIDE, EMERGENCY = range(5)
DRIVER, LANE_KEEPING = range(2)
PARTIAL, FULL = 2, 3
PER_ACCELERATION = 1600 * 0.31


class Car:
    """The controls with what was said last; all is released and off at first."""

    def __init__(self, new_part: NewPart, speed: float = 25.0, **parameters: float) -> None:
        self.part = new_part("driver_controls", **parameters)
        self.part["driver.set_speed"], self.part["speed"] = 30.0, speed
        self.part["cruise_demand.drive_torque"] = 400.0
        self.is_new = True

    def step(self, **said: Any) -> Any:
        names = {"drive": "cruise_demand.drive_torque", "held": "cruise_demand.brake_torque", "lane": "lane_steering"}
        for name, value in said.items():
            own = f"driver.{name}" if name in DRIVER_PORTS else name
            self.part[names.get(name, own)] = value
        if self.is_new:
            self.part.init()
            self.is_new = False
        self.part.step()
        return self

    def __getitem__(self, name: str) -> Any:
        return self.part[name]

    @property
    def torques(self) -> tuple[float, float]:
        return self.part["demand.drive_torque"], self.part["demand.brake_torque"]


DRIVER_PORTS = ("accelerator", "brake", "steering", "hands_on", "cruise", "set_speed")


def test_cruise_control_that_is_switched_on_is_heard_as_it_is(new_part: NewPart) -> None:
    car = Car(new_part).step(cruise=True)
    assert (car["mode"], car.torques) == (CRUISE, (400.0, 0.0))
    assert (car.step(drive=0.0, held=700.0)["mode"], car.torques) == (CRUISE, (0.0, 700.0))
    assert (car.step(cruise=False)["mode"], car.torques[0]) == (MANUAL, 0.0)


def test_a_touch_of_the_brake_puts_it_on_standby_within_one_step_until_it_is_switched_on_anew(
    new_part: NewPart,
) -> None:
    car = Car(new_part).step(cruise=True)
    assert car.step(brake=0.5)["mode"] == STANDBY
    assert car.torques == (0.0, pytest.approx(0.5 * 9 * PER_ACCELERATION))
    assert [car.step(brake=0.0)["mode"] for _ in range(50)] == [STANDBY] * 50
    assert car.torques[0] == 0.0
    assert car.step(cruise=False)["mode"] == MANUAL
    assert car.step(cruise=True, brake=0.5)["mode"] == STANDBY  # not while the driver brakes
    car.step(cruise=False, brake=0.0)
    assert (car.step(cruise=True)["mode"], car.torques[0]) == (CRUISE, 400.0)


def test_the_accelerator_overrides_and_leaves_it_on(new_part: NewPart) -> None:
    car = Car(new_part).step(cruise=True, drive=0.0, held=900.0)
    assert (car.step(accelerator=0.6)["mode"], car.torques[1]) == (OVERRIDE, 0.0)
    assert car.torques[0] == pytest.approx(0.6 * 120e3 * 0.31 / 25)
    assert (car.step(accelerator=0.0)["mode"], car.torques) == (CRUISE, (0.0, 900.0))
    # Less than it drives by itself is no override.
    assert (car.step(accelerator=0.1, drive=1000.0, held=0.0)["mode"], car.torques) == (CRUISE, (1000.0, 0.0))


def test_its_brake_is_let_go_of_slowly_when_it_is_switched_off(new_part: NewPart) -> None:
    car = Car(new_part, overrun=0.0, release_rate=4000.0).step(cruise=True, drive=0.0, held=1000.0)
    assert [car.step(cruise=False).torques[1] for _ in range(3)] == pytest.approx([1000.0, 960.0, 920.0])
    assert car.step(accelerator=0.5).torques[1] == 0.0  # but at once for who accelerates


def test_the_emergency_brake_ends_cruising_for_good(new_part: NewPart) -> None:
    car = Car(new_part).step(cruise=True)
    assert car.step(stage=1)["mode"] == CRUISE  # a warning is for the driver
    assert car.step(stage=FULL)["mode"] == EMERGENCY
    assert car.step(stage=0)["mode"] == STANDBY


def test_released_pedals_slow_down_and_hold_the_car_that_stands(new_part: NewPart) -> None:
    assert Car(new_part, overrun=0.5).step().torques == (0.0, pytest.approx(0.5 * PER_ACCELERATION))
    assert Car(new_part, speed=0.0, hold_torque=800.0).step().torques == (0.0, 800.0)
    standing = Car(new_part, speed=0.0, hold_torque=800.0).step(accelerator=0.2)
    assert standing.torques == (pytest.approx(600.0), 0.0)


def test_the_cruise_control_follows_the_cars_speed_until_it_drives_and_then_comes_to_the_set_speed(
    new_part: NewPart,
) -> None:
    car = Car(new_part, set_speed_rate=3.0).step()
    assert car["set_speed"] == 25.0
    assert car.step(speed=20.0)["set_speed"] == 20.0
    assert [car.step(cruise=True)["set_speed"] for _ in range(3)] == pytest.approx([20.03, 20.06, 20.09])
    for _ in range(1000):
        assert car.step()["set_speed"] <= 30.0
    assert car["set_speed"] == 30.0
    assert Car(new_part).step(cruise=True)["set_speed"] == 30.0  # on from the start: nothing to come to


def test_hands_on_the_wheel_steer_from_the_same_step_and_begin_where_it_stands(new_part: NewPart) -> None:
    car = Car(new_part, speed=2.0, hand_rate=1.0).step(lane=0.1)
    assert (car["steering"], car["steered_by"]) == (0.1, LANE_KEEPING)
    assert car.step(hands_on=True, steering=-0.2, lane=0.3)["steered_by"] == DRIVER
    assert car["steering"] == pytest.approx(0.09)
    for _ in range(40):
        car.step()
    assert car["steering"] == pytest.approx(-0.2)


def test_lane_keeping_gets_the_wheel_back_with_a_rate_and_then_has_it_to_the_bit(new_part: NewPart) -> None:
    car = Car(new_part, speed=2.0, return_rate=0.2).step(hands_on=True, steering=0.0, lane=0.005)
    assert [car.step(hands_on=False)["steering"] for _ in range(3)] == pytest.approx([0.002, 0.004, 0.005])
    assert car.step(lane=0.4321)["steering"] == 0.4321


@pytest.mark.parametrize("speed", [0.0, 5.0, 15.0, 30.0, 60.0])
def test_full_lock_gives_no_more_than_the_lateral_acceleration(new_part: NewPart, speed: float) -> None:
    car = Car(new_part, speed=speed, max_lateral_acceleration=6.0, hand_rate=100.0).step(hands_on=True, steering=5.0)
    for _ in range(3):
        car.step()
    assert 0 < car["steering"] <= 0.6
    assert speed**2 / 2.7 * car["steering"] <= 6.0 * (1 + 1e-12)


@pytest.fixture(scope="module")
def shelf(tmp_path_factory: pytest.TempPathFactory) -> Shelf:
    return Shelf(tmp_path_factory.mktemp("controls"), WORKSPACE)


PEDAL = st.sampled_from([0.0, 0.01, 0.3, 1.0, -1.0, 7.0])
STEP = st.fixed_dictionaries(
    {
        "accelerator": PEDAL,
        "brake": PEDAL,
        "cruise": st.booleans(),
        "hands_on": st.booleans(),
        "steering": st.floats(-2, 2),
        "set_speed": st.floats(0, 60),
        "speed": st.floats(-5, 70),
        "drive": st.sampled_from([0.0, 500.0, 3000.0]),
        "held": st.sampled_from([0.0, 800.0]),
        "lane": st.floats(-0.3, 0.3),
        "stage": st.integers(0, 3),
    }
)


@given(st.lists(STEP, min_size=1, max_size=12))
@settings(max_examples=80, deadline=None)
def test_whatever_is_done_the_brake_wins_and_torques_and_wheel_stay_within_limits(
    shelf: Shelf, said: list[dict[str, Any]]
) -> None:
    car, arbiter = Car(shelf.part), shelf.part("highest_brake")
    arbiter.init()
    last_speed = None
    for each in said:
        car.step(**each)
        drive, brake = car.torques
        assert 0 <= drive <= 3000.0 or (car["mode"] == CRUISE and drive == each["drive"])
        assert brake >= 0
        if each["brake"] > 0.02:  # within this very step
            assert drive == 0
            assert brake >= min(each["brake"], 1) * 9 * PER_ACCELERATION * (1 - 1e-12)
            assert car["mode"] in (MANUAL, STANDBY, EMERGENCY)
        if each["stage"] >= PARTIAL:
            assert car["mode"] == EMERGENCY
        if each["hands_on"]:
            assert car["steered_by"] == DRIVER
        assert abs(car["steering"]) <= 0.6
        if car["mode"] in (CRUISE, OVERRIDE):
            # Never told of more than what is set, but on the way down to it.
            assert car["set_speed"] <= max(
                each["set_speed"], last_speed if last_speed is not None else each["set_speed"]
            )
        last_speed = car["set_speed"]
        arbiter["demand.drive_torque"], arbiter["demand.brake_torque"] = drive, brake
        arbiter["emergency_torque"] = 4000.0 if each["stage"] >= PARTIAL else 0.0
        arbiter.step()
        if each["stage"] >= PARTIAL:
            assert arbiter["drive_torque"] == 0
            assert arbiter["brake_torque"] >= 4000.0
