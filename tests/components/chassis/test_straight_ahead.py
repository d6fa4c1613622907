"""Driving, braking, standing: closed forms along the road."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

NewCar = Callable[..., Any]
NewPart = Callable[..., Any]
ALL = ("longitudinal", "single_track", "two_track")
DYNAMIC = ALL[1:]
G, MASS, RADIUS, INERTIA, HEIGHT, WHEELBASE, SHARE = 9.81, 1600.0, 0.31, 2.0, 0.55, 2.7, 0.55
DRAG = 0.5 * 1.2 * 0.65


def ground(slope_x: float, slope_y: float, friction: float = 1.0) -> Callable[[float, float], tuple[float, ...]]:
    return lambda x, y: (slope_x * x + slope_y * y, slope_x, slope_y, friction)


COURSE = [(1.0, 0.0, 0.0), (2.0, 900.0, 0.0), (1.0, -200.0, 0.0), (2.0, 0.0, 3000.0), (2.0, 400.0, 0.0)]


def test_longitudinal_has_the_numbers_of_straight_road(new_car: NewCar, new_part: NewPart) -> None:
    car, road = new_car("longitudinal", initial_speed=18.0).start(), new_part("straight_road", initial_speed=18.0)
    road.init()
    for duration, drive, brake in COURSE:
        for part in (car, road):
            part["wheels.front"], part["wheels.rear"] = drive, 0.2 * drive
            part["brake.front"], part["brake.rear"] = 0.6 * brake, 0.4 * brake
        for _ in range(round(100 * duration)):
            car.drive(0.01)
            road.step(0.01)
            for name in ("speed", "acceleration", "wheel_speed.front", "wheel_speed.rear"):
                assert car[name] == road[name]
            # Ways are summed once more: the rounding of some hundred sums.
            assert car["position"] == car["motion.x"] == pytest.approx(road["position"], rel=1e-13)
    assert road["speed"] > 1


def test_longitudinal_climbs_as_straight_road_does(new_car: NewCar, new_part: NewPart) -> None:
    uphill = new_car("longitudinal", ground(0.03, -0.04), initial_speed=18.0).start(heading=math.atan2(-0.04, 0.03))
    road = new_part("straight_road", initial_speed=18.0, grade=0.05)
    road.init()
    uphill.drive(5.0)
    for _ in range(500):
        road.step(0.01)
    assert uphill["speed"] == pytest.approx(road["speed"], rel=1e-12)
    assert uphill["pitch"] == pytest.approx(-math.atan(0.05), rel=1e-12)
    assert uphill["roll"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", ALL)
def test_coasting_down_follows_the_closed_form(new_car: NewCar, name: str) -> None:
    car = new_car(name, initial_speed=30.0).start()
    car.drive(30.0)
    # m_e v' = -A v^2 - B, with m_e = m + 2 I / R^2; that rolling wheels slip by some 1e-4 is no part of it.
    total, resisting = MASS + 2 * INERTIA / RADIUS**2, 0.01 * MASS * G
    per = math.sqrt(DRAG / resisting)
    speed = math.tan(math.atan(30 * per) - math.sqrt(DRAG * resisting) / total * 30.0) / per
    assert car["speed"] == pytest.approx(speed, rel=1e-4)


@pytest.mark.parametrize("name", ALL)
def test_the_braking_distance_without_lock_is_that_of_the_torque(new_car: NewCar, name: str) -> None:
    car = new_car(name, initial_speed=25.0, drag_area=0.0).start()
    car.drive(1.0)
    before, way = car["speed"], car["position"]
    car.brake(1500.0, 900.0)
    while car["speed"] > 5.0:
        car.drive(0.01)
    deceleration = (2400.0 / RADIUS + 0.01 * MASS * G) / (MASS + 2 * INERTIA / RADIUS**2)
    # Brakes work over the turn of the wheels, which slip by up to 3 %, and build up within some 10 ms.
    assert car["position"] - way == pytest.approx((before**2 - car["speed"] ** 2) / 2 / deceleration, rel=0.015)


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("friction", [0.3, 1.0])
def test_locked_wheels_brake_with_sliding_friction(new_car: NewCar, name: str, friction: float) -> None:
    car = new_car(name, ground(0, 0, friction), initial_speed=30.0, drag_area=0.0).start()
    car.brake(15_000.0, 15_000.0)
    car.drive(1.0)
    assert [car[f"wheel_speeds[{i}]"] for i in range(1, 5)] == pytest.approx([0.0] * 4, abs=1e-2)
    before, way = car["speed"], car["position"]
    while car["speed"] > 3.0:
        car.drive(0.01)
    if name == "two_track":
        sliding = sum(car[f"load[{i}]"] * locked_friction(car[f"load[{i}]"], 0.8 * friction) for i in range(1, 5))
        sliding /= MASS
    else:
        sliding = 0.9 * friction * G  # to within (friction / stiffness)^2 / 2
    assert (before**2 - car["speed"] ** 2) / 2 / (car["position"] - way) == pytest.approx(sliding, rel=0.01)


def locked_friction(load: float, grip: float) -> float:
    """Force per load at slip -1 (Pacejka 2012, 4.3.2)."""
    more = load / 4850.0 - 1
    friction = grip * (1.1739 - 0.16395 * more)
    b = (22.303 + 0.48896 * more) * math.exp(0.21253 * more) / (1.6411 * friction)
    return friction * math.sin(1.6411 * math.atan(b - 0.46403 * (b - math.atan(b))))


@pytest.mark.parametrize("name", DYNAMIC)
def test_wheels_lock_stay_locked_and_roll_again(new_car: NewCar, name: str) -> None:
    car = new_car(name, initial_speed=20.0).start()
    car.brake(8000.0, 500.0)
    spins: list[float] = []
    car.drive(0.5, each=lambda: spins.append(car["wheel_speed.front"]))
    locked = spins.index(0.0)
    assert locked < 20
    assert spins[locked:] == [0.0] * (50 - locked)  # no creep, no chatter
    assert car["wheel_speed.rear"] * RADIUS > 0.9 * car["speed"]
    car.brake(0.0, 0.0)
    car.drive(0.2)
    assert car["wheel_speed.front"] * RADIUS == pytest.approx(car["speed"], rel=0.01)


@pytest.mark.parametrize("name", DYNAMIC)
@pytest.mark.parametrize(("slope_x", "slope_y"), [(0.2, 0.0), (-0.2, 0.0), (0.0, 0.2), (0.12, -0.1)])
def test_brakes_hold_a_standing_car_on_a_grade_and_a_bank(
    new_car: NewCar, name: str, slope_x: float, slope_y: float
) -> None:
    car = new_car(name, ground(slope_x, slope_y)).start()
    car.brake(1500.0, 1500.0)
    car.drive(4.0)
    place = car["motion.x"], car["motion.y"]
    assert math.hypot(*place) < 0.05  # tyres and springs give way
    car.drive(20.0)
    assert math.dist((car["motion.x"], car["motion.y"]), place) < 1e-6
    rest = car.parameters("speed", "motion.lateral_speed", "motion.yaw_rate", "acceleration")
    assert rest == pytest.approx([0.0] * 4, abs=1e-7)
    assert [car[f"wheel_speeds[{i}]"] for i in range(1, 5)] == [0.0] * 4


@pytest.mark.parametrize("name", DYNAMIC)
@pytest.mark.parametrize("brake", [600.0, 2500.0, 20_000.0])
def test_a_car_brakes_to_a_standstill_without_chatter(new_car: NewCar, name: str, brake: float) -> None:
    car = new_car(name, initial_speed=8.0).start()
    car.brake(brake, 0.6 * brake)
    speeds: list[float] = []
    car.drive(16.0, each=lambda: speeds.append(car["speed"]))
    # A sliding tyre is bent by S mu / c = 11 mm, and gives that back: v^2 = 2 mu g 11 mm. Springs add to it.
    assert min(speeds) > -0.6
    stopped = next(i for i, speed in enumerate(speeds) if speed < 0)
    assert max(np.diff(speeds[:stopped])) < 1e-3
    assert abs(car["speed"]) < 1e-6
    assert [car[f"wheel_speeds[{i}]"] for i in range(1, 5)] == [0.0] * 4


@pytest.mark.parametrize("name", DYNAMIC)
def test_a_car_without_torque_stays_where_it_is(new_car: NewCar, name: str) -> None:
    car = new_car(name).start()
    car.drive(5.0)
    names = ("motion.x", "motion.y", "speed", "motion.yaw_rate", "roll", "pitch", "wheel_speed.front")
    assert car.parameters(*names) == pytest.approx([0.0] * len(names), abs=1e-12)


@pytest.mark.parametrize("name", ALL)
def test_loads_shift_by_what_brakes_take(new_car: NewCar, name: str) -> None:
    car = new_car(name, initial_speed=30.0, drag_area=0.0).start()
    car.brake(1500.0, 900.0)
    car.drive(3.0)
    front = car["load[1]"] + car["load[2]"]
    shifted = -car["acceleration"] * MASS * HEIGHT / WHEELBASE
    if name == "two_track":
        shifted -= MASS * G * HEIGHT * -car["pitch"] / WHEELBASE  # the centre of gravity has moved ahead
    assert front - SHARE * MASS * G == pytest.approx(shifted, rel=2e-3)
    assert car.load() == pytest.approx(MASS * G, rel=1e-4)


@pytest.mark.parametrize("name", ALL)
def test_torque_is_kept_as_motion_height_and_heat(new_car: NewCar, name: str) -> None:
    """Uphill: work of the wheels = motion + height + drag + rolling + slip, over four seconds."""
    car = new_car(name, ground(0.05, 0.0), initial_speed=15.0).start()
    car["wheels.front"] = car["wheels.rear"] = 400.0
    car.drive(1.0)  # springs and tyres settle
    work = heat = 0.0

    def energy() -> float:
        spin = sum(0.5 * 0.5 * INERTIA * car[f"wheel_speeds[{i}]"] ** 2 for i in range(1, 5))
        return 0.5 * MASS * car["speed"] ** 2 + spin + MASS * G * 0.05 * car["motion.x"]

    before, last = energy(), rates(car)
    for _ in range(4000):
        car.drive(0.001, 0.001)
        now = rates(car)
        for i, rate in enumerate(now):
            mean = 0.5 * (rate + last[i]) * 0.001
            work, heat = (work + mean, heat) if i == 0 else (work, heat + mean)
        last = now
    assert work == pytest.approx(energy() - before + heat, rel=2e-4)
    assert work > 100e3


def rates(car: Any) -> list[float]:
    """Power of the torques, of drag, of rolling resistance and of slip."""
    speed = car["speed"]
    power, rolling, slip = 0.0, 0.0, 0.0
    for i in range(1, 5):
        spin, load = car[f"wheel_speeds[{i}]"], car[f"load[{i}]"]
        power += 200.0 * spin
        rolling += 0.01 * RADIUS * load * spin
        force = (200.0 - 0.01 * RADIUS * load - 0.5 * INERTIA * car["acceleration"] / RADIUS) / RADIUS
        slip += force * (RADIUS * spin - speed)
    return [power, DRAG * speed**3, rolling, slip]


@pytest.mark.parametrize("name", DYNAMIC)
def test_errors_fall_with_the_square_of_the_step(new_car: NewCar, name: str) -> None:
    course: Sequence[tuple[float, float, float, float]] = (
        (0.5, 0.04, 600.0, 0.0), (0.5, -0.05, 0.0, 1500.0), (0.3, 0.02, 300.0, 0.0)
    )  # fmt: skip

    def end(substeps: int) -> Any:
        car = new_car(name, initial_speed=22.0, substeps=substeps).start()
        for duration, steering, drive, brake in course:
            car["steering"], car["wheels.front"], car["brake.front"] = steering, drive, brake
            car.drive(duration)
        names = ("motion.x", "motion.y", "speed", "motion.lateral_speed", "motion.yaw_rate", "motion.heading")
        return np.array(car.parameters(*names, "wheel_speed.front", "wheel_speed.rear", "load[1]"))

    exact = end(640)
    errors = [abs(end(substeps) - exact) for substeps in (10, 20, 40)]
    for coarse, fine in pairwise(errors):
        assert np.log2(coarse / fine).mean() == pytest.approx(2.0, abs=0.2)
    one_step = abs(end(1 if name == "single_track" else 5) - exact)
    assert max(one_step[:2]) < 0.02  # m, with the substeps that it starts with
