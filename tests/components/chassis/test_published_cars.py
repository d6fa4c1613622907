"""The cars of CommonRoad's tables are here with CommonRoad's numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

NewPart = Callable[..., Any]
CARS = {1: "escort", 2: "320i", 3: "vanagon"}


@pytest.mark.parametrize("number", CARS)
@pytest.mark.parametrize("name", ["single_track", "two_track"])
def test_a_published_car_has_its_published_parameters(new_part: NewPart, name: str, number: int) -> None:
    from vehiclemodels.vehicle_parameters import setup_vehicle_parameters

    p, car = setup_vehicle_parameters(vehicle_id=number), new_part(f"{name}_{CARS[number]}")
    expected = {
        "mass": p.m,
        "yaw_inertia": p.I_z,
        "front_load_share": p.b / (p.a + p.b),
        "cg_height": p.h_cg,
        "wheelbase": p.a + p.b,
        "wheel_radius": p.R_w,
        "inertia_front": 2 * p.I_y_w,  # of one wheel there, of two here
        "inertia_rear": 2 * p.I_y_w,
    }
    if name == "single_track":
        stiffness = dict.fromkeys(("cornering_stiffness_front", "cornering_stiffness_rear"), -p.tire.p_ky1)
        expected |= {"friction": p.tire.p_dy1, "slip_stiffness": p.tire.p_kx1, **stiffness}
    else:
        expected |= {
            "roll_inertia": p.I_Phi_s,
            "pitch_inertia": p.I_y_s,
            "track_front": p.T_f,
            "track_rear": p.T_r,
            "spring_front": 1 / (1 / p.K_sf + 1 / p.K_zt),
            "spring_rear": 1 / (1 / p.K_sr + 1 / p.K_zt),
            "damper_front": p.K_sdf,
            "damper_rear": p.K_sdr,
            "anti_roll_front": -p.K_tsf,
            "anti_roll_rear": -p.K_tsr,
            "tyre.grip": 1.0,
        }
        names = ("cx1", "dx1", "ex1", "kx1", "cy1", "dy1", "ey1")
        expected |= {f"tyre.p{coefficient}": getattr(p.tire, f"p_{coefficient}") for coefficient in names}
        expected |= {
            f"tyre.r{n}": getattr(p.tire, f"r_{n}") for n in ("bx1", "bx2", "cx1", "ex1", "by1", "by2", "cy1", "ey1")
        }
    assert {key: car[key] for key in expected} == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("name", ["single_track", "two_track"])
def test_published_cars_take_a_bend(new_part: NewPart, name: str) -> None:
    for suffix in CARS.values():
        car = new_part(f"{name}_{suffix}", initial_speed=15.0)
        for i in range(1, 5):
            car[f"ground[{i}].friction"] = 1.0
        car.init()
        car["steering"] = 0.05
        for _ in range(200):
            car.step()
        # Little slower than it began, and near the curvature of its steering.
        assert 14.0 < car["speed"] < 15.0
        assert car["motion.yaw_rate"] / car["speed"] == pytest.approx(0.05 / car["wheelbase"], rel=0.35)
        assert sum(car[f"load[{i}]"] for i in range(1, 5)) == pytest.approx(9.81 * car["mass"], rel=0.01)
