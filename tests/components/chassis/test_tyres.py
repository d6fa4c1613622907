"""The tyre of two_track against the published formula, and against CommonRoad's code of it, through a driver in C."""

from __future__ import annotations

import ctypes
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

from dse.fmu.toolchain.compiler import find_compiler

SHARED = Path(__file__).parents[3] / "components" / "chassis" / "shared"
DRIVER = """
#include "tyre.h"
void drive(const double *p, double slip, double side, double load, double friction, double *out);
void drive(const double *p, double slip, double side, double load, double friction, double *out) {
    tyre t = {
        .law = (tyre_law)p[0], .friction = 1, .nominal_load = 4850,
        .slip_stiffness = p[1], .slip_stiffness_load = p[2], .slip_stiffness_exponent = p[3],
        .side_stiffness = p[4], .side_stiffness_peak = p[5],
        .along = {1.6411, 1.1739, p[6], 0.46403, 13.276, -13.778, 1.2568, 0.65225},
        .across = {1.3507, 1.0489, p[7], -0.0074722, 7.1433, 9.1916, 1.0719, -0.27572},
    };
    tyre_state s = tyre_under(&t, load, friction);
    tyre_grip g = tyre_grip_at(&t, &s, slip, side);
    out[0] = g.x, out[1] = g.y, out[2] = g.x_by_slip, out[3] = g.y_by_slip;
}
"""
LINEAR, LIMITED, MAGIC = 0.0, 1.0, 2.0
PUBLISHED = (MAGIC, 22.303, 0.48896, 0.21253, 21.92, 2.0012, -0.16395, -0.18033)
COMMONROAD = (MAGIC, 22.303, 0.0, 0.0, 21.92 * 1e9 / 2, 1e9, 0.0, 0.0)  # proportional to the load
Grip = Callable[..., list[float]]

slips = st.floats(-1.5, 3)
angles = st.floats(-1.4, 1.4)
loads = st.floats(50, 12_000)


@pytest.fixture(scope="module")
def grip(tmp_path_factory: pytest.TempPathFactory) -> Grip:
    """Forces per load, and their derivatives by the slip: of a tyre, its slip, slip angle, load and friction."""
    folder = tmp_path_factory.mktemp("tyre")
    (folder / "driver.c").write_text(DRIVER, encoding="utf-8")
    target = folder / f"driver{'.dll' if sys.platform == 'win32' else '.so'}"
    options = ["-std=c99", "-O2", "-ffp-contract=off", "-shared", f"-I{SHARED}"]
    options += [] if sys.platform == "win32" else ["-fPIC"]
    math_library = [] if sys.platform == "win32" else ["-lm"]
    units = [str(SHARED / "tyre.c"), str(folder / "driver.c")]
    subprocess.run([*find_compiler().command, *options, *units, "-o", str(target), *math_library], check=True)
    library = ctypes.CDLL(str(target))
    library.drive.argtypes = [ctypes.c_double * 8, *[ctypes.c_double] * 4, ctypes.c_double * 4]

    def ask(tyre: tuple[float, ...], slip: float, angle: float, load: float = 4000.0, friction: float = 1.0) -> Any:
        out = (ctypes.c_double * 4)()
        library.drive((ctypes.c_double * 8)(*tyre), slip, math.tan(angle), load, friction, out)
        return list(out)

    return ask


def magic(x: float, b: float, c: float, e: float) -> float:
    """C atan(B x - E (B x - atan(B x)))"""
    return c * math.atan(b * x - e * (b * x - math.atan(b * x)))


def published(slip: float, angle: float, load: float, friction: float) -> tuple[float, float]:
    """Pacejka 2012, 4.3.2, equations 4.E9 to 4.E61 without camber, shifts and ply steer: forces, not per load."""
    nominal = 4850.0
    dfz = (load - nominal) / nominal
    stiffness_x = load * (22.303 + 0.48896 * dfz) * math.exp(0.21253 * dfz)
    peak_x = (1.1739 - 0.16395 * dfz) * friction * load
    pure_x = peak_x * math.sin(magic(slip, stiffness_x / (1.6411 * peak_x), 1.6411, 0.46403))
    stiffness_y = 21.92 * nominal * math.sin(2 * math.atan(load / (2.0012 * nominal)))
    peak_y = (1.0489 - 0.18033 * dfz) * friction * load
    pure_y = peak_y * math.sin(magic(angle, stiffness_y / (1.3507 * peak_y), 1.3507, -0.0074722))
    less_x = math.cos(magic(angle, 13.276 * math.cos(math.atan(-13.778 * slip)), 1.2568, 0.65225))
    less_y = math.cos(magic(slip, 7.1433 * math.cos(math.atan(9.1916 * angle)), 1.0719, -0.27572))
    return pure_x * less_x, pure_y * less_y


def test_the_slip_curves_are_those_of_the_published_formula(grip: Grip) -> None:
    @settings(max_examples=400, deadline=None, derandomize=True)
    @given(slip=slips, angle=angles, load=loads, friction=st.floats(0.05, 1.2))
    def check(slip: float, angle: float, load: float, friction: float) -> None:
        x, y, *_ = grip(PUBLISHED, slip, angle, load, friction)
        # Rounding of a dozen functions, of forces of up to 1 per load.
        assert (x, y) == pytest.approx([f / load for f in published(slip, angle, load, friction)], rel=1e-9, abs=1e-12)

    check()


def test_the_slip_curves_are_those_of_commonroad(grip: Grip) -> None:
    from vehiclemodels.utils.tire_model import (
        formula_lateral,
        formula_lateral_comb,
        formula_longitudinal,
        formula_longitudinal_comb,
    )
    from vehiclemodels.vehicle_parameters import setup_vehicle_parameters

    tire = setup_vehicle_parameters(vehicle_id=1).tire
    for name in ("p_hx1", "p_vx1", "r_hx1", "r_by3", "r_hy1", "r_vy1"):
        setattr(tire, name, 0.0)

    @settings(max_examples=200, deadline=None, derandomize=True)
    @given(slip=slips, angle=angles, load=loads)
    def check(slip: float, angle: float, load: float) -> None:
        # Theirs: slip > 0 brakes, and a positive angle pushes to the right.
        x = formula_longitudinal_comb(-slip, angle, formula_longitudinal(-slip, 0, load, tire), tire)
        pure, friction = formula_lateral(-angle, 0, load, tire)
        y = formula_lateral_comb(-slip, -angle, 0, friction, load, pure, tire)
        assert grip(COMMONROAD, slip, angle, load)[:2] == pytest.approx([x / load, y / load], rel=1e-9, abs=1e-12)

    check()


@pytest.mark.parametrize("law", [LINEAR, LIMITED, MAGIC])
def test_the_derivatives_are_those_of_the_forces(grip: Grip, law: float) -> None:
    tyre = (law, *PUBLISHED[1:])

    @settings(max_examples=200, deadline=None, derandomize=True)
    @given(slip=st.floats(-1, 1), angle=angles, load=loads)
    def check(slip: float, angle: float, load: float) -> None:
        h = 1e-6
        more, less = grip(tyre, slip + h, angle, load), grip(tyre, slip - h, angle, load)
        expected = [(more[i] - less[i]) / (2 * h) for i in range(2)]
        # The difference is good to h^2 times the third derivative, some 1e4 where the tyre begins to slide.
        assert grip(tyre, slip, angle, load)[2:] == pytest.approx(expected, rel=1e-6, abs=1e-6)

    check()


def test_a_limited_tyre_stays_in_its_friction_circle(grip: Grip) -> None:
    tyre = (LIMITED, *PUBLISHED[1:])

    @settings(max_examples=200, deadline=None, derandomize=True)
    @given(slip=slips, angle=angles, friction=st.floats(0.01, 1.5))
    def check(slip: float, angle: float, friction: float) -> None:
        x, y, *_ = grip(tyre, slip, angle, 4000.0, friction)
        assert math.hypot(x, y) <= friction * (1 + 1e-12)
        if math.hypot(slip, math.tan(angle)) > 0.9:
            # To within (friction / stiffness)^2 / 2.
            assert math.hypot(x, y) >= friction * (1 - 0.6 * (friction / 19) ** 2)

    check()
