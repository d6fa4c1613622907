"""The chassis against CommonRoad's vehicle models (Althoff, Wuersching 2020), where the equations are the same.

What coincides, and why:

- KS has no dynamics: its rear axle rolls without slip. `longitudinal` does so too; its speed is given to KS.
- ST has linear tyres, small angles and no wheels. `single_track` with the law `linear`, no relaxation lengths, no drag
  and no rolling resistance has the same limit; steering is so small (0.3 mrad) that its square counts for nothing. ST's
  loads follow from a demanded acceleration, ours from the forces: with acceleration only derivatives are compared, at
  an acceleration that is there.
- STD has the Magic Formula and spins. `two_track` is the same with tracks of nothing, and with its centre of gravity on
  the ground, as STD's loads follow from the demanded acceleration too. Shifts and ply steer of the tyre are zero, as
  ours are the same left and right (and STD adds SVx inside of its sine). STD's stiffness is proportional to the load,
  as ours is below a peak at 1e9 nominal loads. Torques are those that STD makes of its demanded acceleration.
- Below 0.2 m/s ST and STD turn into KS; nothing is compared there.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

NewCar = Callable[..., Any]
State = NDArray[np.float64]
PEAK = 1e9  # nominal loads, where cornering stiffness is highest: it is proportional to the load
SYMMETRIC = ("p_hx1", "p_vx1", "p_hy1", "p_hy3", "p_vy1", "p_vy3", "r_hx1", "r_by3", "r_hy1", "r_vy1", "r_vy3")

MAGIC = ("pcx1", "pdx1", "pex1", "pkx1", "rbx1", "rbx2", "rcx1", "rex1")
MAGIC += ("pcy1", "pdy1", "pey1", "rby1", "rby2", "rcy1", "rey1")


def vehicle(number: int) -> Any:
    from vehiclemodels.vehicle_parameters import setup_vehicle_parameters

    found = setup_vehicle_parameters(vehicle_id=number)
    for name in SYMMETRIC:
        setattr(found.tire, name, 0.0)
    return found


def same(p: Any) -> dict[str, float]:
    """What every chassis takes of a set of CommonRoad's, without what its models leave out."""
    return {
        "mass": p.m,
        "front_load_share": p.b / (p.a + p.b),
        "wheelbase": p.a + p.b,
        "wheel_radius": p.R_w,
        "inertia_front": p.I_y_w,
        "inertia_rear": p.I_y_w,
        "drag_area": 0.0,
        "rolling_resistance": 0.0,
    }


def solve(model: Callable[..., list[float]], start: State, duration: float, u: list[float], p: Any) -> State:
    found = solve_ivp(lambda _, x: model(list(x), u, p), (0, duration), start, method="LSODA", rtol=1e-11, atol=1e-11)
    return np.array(found.y[:, -1])


def runge_kutta(model: Callable[..., list[float]], x: State, step: float, u: list[float], p: Any) -> State:
    first = np.array(model(x, u, p))
    second = np.array(model(x + step / 2 * first, u, p))
    third = np.array(model(x + step / 2 * second, u, p))
    return x + step / 6 * (first + 2 * second + 2 * third + np.array(model(x + step * third, u, p)))


def test_longitudinal_is_ks(new_car: NewCar) -> None:
    from vehiclemodels.vehicle_dynamics_ks import vehicle_dynamics_ks

    p = vehicle(1)
    car = new_car("longitudinal", initial_speed=12.0, substeps=100, **same(p)).start(3.0, -2.0, 0.7)
    rear = np.array([3 - p.b * math.cos(0.7), -2 - p.b * math.sin(0.7), 0.0, 12.0, 0.7])
    for steering, torque in ((0.1, 500.0), (-0.3, -800.0), (0.02, 0.0)):
        car["steering"] = rear[2] = steering
        car["wheels.rear"] = torque
        for _ in range(300):
            before = car["speed"]
            car.drive(0.001, 0.001)
            rear = runge_kutta(vehicle_dynamics_ks, rear, 0.001, [0.0, (car["speed"] - before) / 0.001], p)
        heading = car["motion.heading"]
        ours = car["motion.x"] - p.b * math.cos(heading), car["motion.y"] - p.b * math.sin(heading), heading
        # KS has its speed change evenly over a millisecond; the rest is the same.
        assert ours == pytest.approx((rear[0], rear[1], rear[4]), abs=1e-6)


def linear(p: Any) -> dict[str, Any]:
    return {
        **same(p),
        "yaw_inertia": p.I_z,
        "cg_height": p.h_s,
        "side_area": 0.0,
        "tyre": "linear",
        "slip_stiffness": 22.0,
        "cornering_stiffness_front": -p.tire.p_ky1,
        "cornering_stiffness_rear": -p.tire.p_ky1,
        "slip_relaxation": 0.0,
        "side_relaxation": 0.0,
    }


@pytest.mark.parametrize("number", [1, 2, 3])
def test_single_track_is_st(new_car: NewCar, number: int) -> None:
    from vehiclemodels.vehicle_dynamics_st import vehicle_dynamics_st

    p = vehicle(number)
    car = new_car("single_track", initial_speed=14.0, substeps=200, **linear(p)).start()
    x = np.array([0.0, 0.0, 0.0, 14.0, 0.0, 0.0, 0.0])
    for steering in (3e-4, -2e-4, 1e-4):
        car["steering"] = x[2] = steering
        car.drive(0.6)
        x = solve(vehicle_dynamics_st, x, 0.6, [0.0, 0.0], p)
        slip = car["motion.lateral_speed"] / car["motion.speed"]
        ours = [*car.parameters("motion.x", "motion.y", "motion.speed", "motion.heading", "motion.yaw_rate"), slip]
        theirs = [x[0], x[1], x[3], x[4], x[5], x[6]]
        assert ours == pytest.approx(theirs, rel=1e-6, abs=1e-9)  # of yaw rates of 2 mrad/s


def test_single_track_shifts_loads_as_st_does(new_car: NewCar) -> None:
    from vehiclemodels.vehicle_dynamics_st import vehicle_dynamics_st

    p = vehicle(2)
    # ST has no wheels; spinning up a front wheel takes a force that pulls along its steering.
    weightless = {"inertia_front": 1e-6, "inertia_rear": 1e-6}
    car = new_car("single_track", initial_speed=14.0, **{**linear(p), **weightless}).start()
    car["steering"], car["wheels.rear"] = 3e-4, p.m * p.R_w * 2.5
    car.drive(0.4, 1e-4)
    before = car["motion.yaw_rate"]
    car.drive(1e-4, 1e-4)
    speed, slip, rate = car["motion.speed"], car["motion.lateral_speed"] / car["motion.speed"], car["motion.yaw_rate"]
    acceleration, lateral = car["motion.acceleration"], car["motion.lateral_acceleration"]
    car.drive(1e-4, 1e-4)
    yaw_acceleration = (car["motion.yaw_rate"] - before) / 2e-4
    assert acceleration > 2.4
    theirs = vehicle_dynamics_st([0, 0, 3e-4, speed, 0, rate, slip], [0.0, acceleration], p)
    assert yaw_acceleration == pytest.approx(theirs[5], rel=2e-6)
    assert lateral == pytest.approx(speed * (theirs[6] + rate), rel=2e-6)


def drift_car(new_car: NewCar, p: Any, speed: float, substeps: int) -> Any:
    tyre = {name.replace("p_", "p").replace("r_", "r"): value for name, value in vars(p.tire).items()}
    magic = {f"tyre__{name}": tyre[name] for name in MAGIC}
    magic |= {f"tyre__{name}": 0.0 for name in ("slip_relaxation", "side_relaxation", "pdx2", "pkx2", "pkx3", "pdy2")}
    magic |= {"tyre__grip": 1.0, "tyre__pky1": -tyre["pky1"] * PEAK / 2, "tyre__pky2": PEAK}
    flat = {"cg_height": 0.0, "track_front": 1e-9, "track_rear": 1e-9, "anti_roll_front": 0.0, "anti_roll_rear": 0.0}
    parameters = {**same(p), **magic, **flat, "yaw_inertia": p.I_z, "side_area": 0.0}
    return new_car("two_track", initial_speed=speed, substeps=substeps, **parameters).start()


Piece = tuple[float, float, float]  # duration, steering, demanded acceleration
DRIFT: list[Piece] = [(0.5, 0.03, 0.0), (0.7, 0.06, 2.0), (0.6, -0.05, -4.0)]
SLIDE: list[Piece] = [(0.4, 0.2, 0.0), (0.5, -0.2, 3.0), (0.4, 0.0, -7.0)]


def driven(car: Any, course: list[Piece], p: Any) -> list[State]:
    rows = []
    for duration, steering, acceleration in course:
        torque, share = p.m * p.R_w * acceleration, p.T_se if acceleration > 0 else p.T_sb
        car["wheels.front"], car["wheels.rear"], car["steering"] = share * torque, (1 - share) * torque, steering
        car.drive(duration)
        u, v = car["motion.speed"], car["motion.lateral_speed"]
        rest = car.parameters("motion.heading", "motion.yaw_rate")
        spins = car.parameters("wheel_speed.front", "wheel_speed.rear")
        rows.append(np.array([car["motion.x"], car["motion.y"], math.hypot(u, v), *rest, math.atan2(v, u), *spins]))
    return rows


def theirs(course: list[Piece], speed: float, p: Any) -> list[State]:
    from vehiclemodels.vehicle_dynamics_std import vehicle_dynamics_std

    x, rows = np.array([0, 0, 0, speed, 0, 0, 0, speed / p.R_w, speed / p.R_w]), []
    p.h_s = 0.0
    for duration, steering, acceleration in course:
        x[2] = steering
        x = solve(vehicle_dynamics_std, x, duration, [0.0, acceleration], p)
        rows.append(np.delete(x, 2))
    return rows


@pytest.mark.sampled(3)
@pytest.mark.parametrize("course", [DRIFT, SLIDE])
@pytest.mark.parametrize("number", [2, 1, 3])
def test_two_track_without_width_and_height_is_std(new_car: NewCar, number: int, course: list[Piece]) -> None:
    p = vehicle(number)
    for ours, expected in zip(
        driven(drift_car(new_car, p, 15.0, 400), course, p), theirs(course, 15.0, p), strict=True
    ):
        assert ours == pytest.approx(expected, rel=1e-6, abs=1e-6)


def test_against_std_errors_fall_with_the_square_of_the_step(new_car: NewCar) -> None:
    p = vehicle(2)
    exact = theirs(DRIFT, 15.0, p)[-1]
    errors = [abs(driven(drift_car(new_car, p, 15.0, n), DRIFT, p)[-1] - exact).max() for n in (25, 50, 100)]
    for coarse, fine in pairwise(errors):
        assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.15)
