"""Slip control on cars whose wheels can lock and spin, against closed forms."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest

NewPart = Callable[..., Any]
G, LIMIT = 9.81, 5 / 3.6
PEAK = {"two_track": 0.8 * 1.1739, "single_track": 0.9}  # friction on dry asphalt, at the nominal load
SURFACES = {"dry": 1.0, "wet": 0.71, "snow": 0.3, "ice": 0.1}


class Car:
    """A chassis with slip control, on ground of one friction at the left and one at the right."""

    def __init__(
        self, new_part: NewPart, chassis: str, control: str, left: float, right: float, speed: float, **more: float
    ) -> None:
        self.chassis, self.control = new_part(chassis, initial_speed=speed, drag_area=0.0, **more), new_part(control)
        for i in range(1, 5):
            self.chassis[f"ground[{i}].friction"] = left if i % 2 else right
        self.chassis.init()
        self.control.init()
        self.time = 0.0

        self.powertrain: Any = None

    def step(self, front: float = 0.0, rear: float = 0.0, drive: float = 0.0) -> None:
        self.control["demand.front"], self.control["demand.rear"] = front, rear
        for i in range(1, 5):
            self.control[f"wheel_speeds[{i}]"] = self.chassis[f"wheel_speeds[{i}]"]
        for name in ("speed", "yaw_rate", "acceleration", "lateral_speed", "lateral_acceleration"):
            self.control[f"motion.{name}"] = self.chassis[f"motion.{name}"]
        self.control["drive_demand"], self.control["steering"] = drive, self.chassis["steering"]
        if self.powertrain:
            for axle in ("front", "rear"):
                self.control[f"wheels.{axle}"] = self.powertrain[f"wheels.{axle}"]
        self.control.step()
        if self.powertrain:
            self.powertrain["torque_demand"] = self.control["drive_torque"]
            self.powertrain.step()
            for axle in ("front", "rear"):
                self.chassis[f"wheels.{axle}"] = self.powertrain[f"wheels.{axle}"]
                self.powertrain[f"wheel_speed.{axle}"] = self.chassis[f"wheel_speed.{axle}"]
        for name in ("brake.front", "brake.rear", *(f"wheel_brake[{i}]" for i in range(1, 5))):
            self.chassis[name] = self.control[name]
        self.chassis.step()
        self.time += 0.01

    def slips(self) -> list[float]:
        return [1 - 0.31 * self.chassis[f"wheel_speeds[{i}]"] / self.chassis["speed"] for i in range(1, 5)]

    def stop(self, steered: bool = False) -> Iterator[list[float]]:
        """Full braking, built up as by a booster, until 5 km/h. With steering, a driver keeps the heading."""
        while self.chassis["speed"] > LIMIT and self.time < 60:
            torque = 6500.0 * (1 - math.exp(-self.time / 0.12))
            if steered:
                self.chassis["steering"] = -1.0 * self.chassis["motion.heading"] - 0.3 * self.chassis["motion.yaw_rate"]
            self.step(0.65 * torque, 0.35 * torque)
            yield self.slips()


@pytest.mark.parametrize("chassis", PEAK)
@pytest.mark.parametrize("friction", SURFACES.values(), ids=SURFACES)
def test_anti_lock_brakes_stop_within_a_tenth_of_the_friction_limit(
    new_part: NewPart, chassis: str, friction: float
) -> None:
    car = Car(new_part, chassis, "anti_lock", friction, friction, 25.0)
    slips = [(car.chassis["speed"], max(row)) for row in car.stop()]
    limit = (25.0**2 - LIMIT**2) / (2 * PEAK[chassis] * friction * G)
    # The brake builds up in 0.12 s, in 3 m. Front wheels on ice have more grip per load than the nominal load, by 2 %.
    assert 0.95 * limit < car.chassis["position"] - 3.0 < 1.1 * limit
    # The peak is at 0.13 * friction, brakes are kept at 0.19 of it. At walking speed the force follows the slip late.
    assert max(slip for speed, slip in slips[50:] if speed > 3) < 0.02 + 0.2 * friction
    assert max(slip for _, slip in slips) < 0.6


def friction_of_two_track(grip: float, ground: float) -> float:
    """Highest deceleration over g: the tyre's friction falls with its load, which braking moves to the front."""
    mean = grip * 1.1739 * ground
    for _ in range(20):
        loads = [0.5 * 1600 * G * (share + sign * mean * 0.55 / 2.7) for share, sign in ((0.55, 1), (0.45, -1))]
        mean = sum(2 * n * grip * (1.1739 - 0.16395 * (n / 4850 - 1)) * ground for n in loads) / (1600 * G)
    return mean


@pytest.mark.parametrize("friction", SURFACES.values(), ids=SURFACES)
def test_both_cars_stop_alike_but_for_the_friction_of_their_tyres(new_part: NewPart, friction: float) -> None:
    """From 50 km/h. The brake builds up in 1.7 m. Brakes are kept at 97 % of the friction of both tyres, within 1 %;
    the rest of the tolerance is the way until the slip is there.
    """

    def way(chassis: str, **more: float) -> float:
        car = Car(new_part, chassis, "anti_lock", friction, friction, 50 / 3.6, **more)
        assert len(list(car.stop())) < 3000
        return float(car.chassis["position"]) - 1.7

    two, single = way("two_track"), way("single_track")
    assert single / two == pytest.approx(friction_of_two_track(0.8, friction) / (0.9 * friction), rel=0.03)
    assert abs(single / two - 1) < 0.1
    same = 0.8 * 0.9 * friction / friction_of_two_track(0.8, friction)
    assert way("two_track", **{"tyre.grip": same}) == pytest.approx(single, rel=0.03)


@pytest.mark.parametrize("friction", [0.71, 0.1])
def test_without_slip_control_wheels_lock_and_the_magic_formula_brakes_less(new_part: NewPart, friction: float) -> None:
    car = Car(new_part, "two_track", "no_slip_control", friction, friction, 25.0)
    slips = list(car.stop())
    assert min(slips[-1]) == 1.0
    assert car.chassis["position"] > 1.3 * (25.0**2 - LIMIT**2) / (2 * PEAK["two_track"] * friction * G)


def test_split_friction_brakes_each_front_wheel_by_its_own_and_the_rear_by_the_lower(new_part: NewPart) -> None:
    car = Car(new_part, "two_track", "anti_lock", 1.0, 0.1, 25.0)
    slips = list(car.stop(steered=True))
    # Front: the mean of both sides. Rear: the lower one, as both wheels have its torque. Loads move by a h / wheelbase.
    high, low = PEAK["two_track"], 0.1 * PEAK["two_track"]
    share = 0.55 * 0.5 * (high + low) + 0.45 * low
    deceleration = share / (1 - 0.55 / 2.7 * (0.5 * (high + low) - low)) * G
    limit = (25.0**2 - LIMIT**2) / (2 * deceleration)
    assert car.chassis["position"] - 3.0 == pytest.approx(limit, rel=0.1)
    assert max(max(row) for row in slips[50:]) < 0.25
    assert abs(car.chassis["motion.heading"]) < math.radians(10)
    assert abs(car.chassis["motion.y"]) < 1.8


def test_brakes_that_need_no_control_pass_unchanged_and_wheels_lock_at_walking_speed(new_part: NewPart) -> None:
    gentle = Car(new_part, "two_track", "anti_lock", 1.0, 1.0, 25.0)
    for _ in range(300):
        gentle.step(601.7, 399.3)
        assert (gentle.control["brake.front"], gentle.control["brake.rear"]) == (601.7, 399.3)
        assert not gentle.control["anti_lock"]
    slow = Car(new_part, "two_track", "anti_lock", 0.1, 0.1, 4.9 / 3.6)
    for _ in range(30):
        slow.step(3000.0, 2000.0)
    assert max(abs(slow.chassis[f"wheel_speeds[{i}]"]) for i in range(1, 5)) == 0.0


def started(new_part: NewPart, control: str, share: float, friction: float, chassis: str = "two_track") -> Car:
    """Eight seconds of full drive torque, built up within half a second, of an electric drive."""
    car = Car(new_part, chassis, control, friction, friction, 0.0, rolling_resistance=0.0)
    car.powertrain = new_part("bev_ideal", front_share=share)
    car.powertrain.init()
    while car.time < 8.0:
        car.step(drive=3000.0 * min(car.time / 0.5, 1.0))
    return car


@pytest.mark.parametrize("chassis", PEAK)
@pytest.mark.parametrize("share", [0.0, 1.0, 0.5])
@pytest.mark.parametrize("friction", [0.1, 0.2, 0.3])
def test_traction_control_starts_within_a_tenth_of_the_friction_limit(
    new_part: NewPart, chassis: str, share: float, friction: float
) -> None:
    car = started(new_part, "traction_control", share, friction, chassis)
    mu, lever = PEAK[chassis] * friction, 0.55 / 2.7
    # Loads move to the rear. With half of the torque at each axle, the rear one slips first.
    limits = {0.0: mu * 0.45 / (1 - mu * lever), 1.0: mu * 0.55 / (1 + mu * lever)}
    limits[0.5] = 2 * mu * 0.45 / (1 - 2 * mu * lever)
    # The demand reaches the limit after 0.25 s at most.
    assert car.chassis["speed"] == pytest.approx(limits[share] * G * 7.75, rel=0.1)


@pytest.mark.parametrize("share", [0.0, 1.0, 0.5])
def test_without_traction_control_driven_wheels_spin_and_the_start_is_slower(new_part: NewPart, share: float) -> None:
    plain, controlled = (started(new_part, name, share, 0.1) for name in ("anti_lock", "traction_control"))
    fastest = max(plain.chassis[f"wheel_speeds[{i}]"] for i in range(1, 5)) * 0.31
    assert fastest > 5 * plain.chassis["speed"]
    assert controlled.chassis["speed"] > 1.1 * plain.chassis["speed"]
    assert not plain.control["traction"]


def change_lanes(new_part: NewPart, control: str, speed: float, friction: float) -> tuple[float, float, float]:
    """Largest distance from a double lane change of 3.5 m, the largest drift angle, and
    the distance 80 m after it."""
    car = Car(new_part, "two_track", control, friction, friction, speed)
    off = drift = 0.0
    while car.chassis["motion.x"] < 175.0 and car.time < 12.0:
        x, y, heading = (car.chassis[f"motion.{name}"] for name in ("x", "y", "heading"))
        ahead = 0.6 * speed + 4.0
        aside = lane(x + ahead) - y - ahead * math.sin(heading)
        car.chassis["steering"] = max(-0.5, min(0.5, 2 * 2.7 * aside / ahead**2))
        car.step()
        off = max(off, abs(y - lane(x)))
        drift = max(drift, abs(math.atan2(car.chassis["motion.lateral_speed"], car.chassis["speed"])))
    return off, drift, abs(y)


def lane(x: float) -> float:
    """Like the lanes of ISO 3888-1: 30 m to the left, 25 m there, 25 m back."""
    left = min(max((x - 15.0) / 30.0, 0.0), 1.0) - min(max((x - 70.0) / 25.0, 0.0), 1.0)
    return 3.5 * 0.5 * (1 - math.cos(math.pi * left))


@pytest.mark.parametrize("speed", [22.0, 23.0, 24.0])
def test_stability_control_holds_a_double_lane_change_on_snow_that_the_plain_car_does_not(
    new_part: NewPart, speed: float
) -> None:
    """The lanes ask for more than 9 m/s2, snow gives less than 3: cars cut the corners, but need not spin."""
    off, drift, after = change_lanes(new_part, "traction_control", speed, 0.3)
    assert (off > 3.0, drift > math.radians(20)) == (True, True)
    held, held_drift, held_after = change_lanes(new_part, "stability_control", speed, 0.3)
    assert held < off
    assert held_drift < math.radians(5)
    assert held_after < min(0.5, after)


def test_stability_control_leaves_a_car_alone_that_follows_its_steering(new_part: NewPart) -> None:
    plain, controlled = (change_lanes(new_part, f"{name}_control", 24.0, 1.0) for name in ("traction", "stability"))
    assert plain == controlled


@pytest.mark.parametrize("value", [math.nan, 1e308, -1e308])
@pytest.mark.parametrize(
    "port", ["demand.front", "drive_demand", "wheels.rear", "wheel_speeds[2]", "motion.speed", "motion.yaw_rate"]
)
def test_an_input_that_is_no_sensible_number_makes_no_such_output(new_part: NewPart, port: str, value: float) -> None:
    control = new_part("stability_control")
    control["demand.front"], control["motion.speed"], control["drive_demand"] = 3000.0, 20.0, 500.0
    control["wheels.rear"], control["steering"] = 500.0, 0.1
    control.init()
    outputs = [each.name for each in control.component.interface.ports if each.causality == "output"]
    for k in range(20):
        control[port] = value if 5 < k < 10 else 0.0
        control.step()
        assert [name for name in outputs if not abs(float(control[name])) <= 2e5] == []
