"""Boundary search on the example's gains, as a user has it, against a fine grid."""

from __future__ import annotations

import shutil
import sqlite3
from contextlib import closing

import numpy as np
import pytest
from judged_points import classes, predicted
from scipy.interpolate import RegularGridInterpolator

STUDY = """\
study: gains
testbench: acc_following
configurations:
  where: >-
    sensor is radar_77ghz_mid and controller is pd_acc and brake is hydraulic_booster
    and powertrain is combustion_ideal and video is absent
design_variables:
  controller.kp_%(loop)s: {range: %(p)s, levels: %(levels)d}
  controller.kd_%(loop)s: {range: %(d)s, levels: %(levels)d}
sampler: %(sampler)s
keep_waveforms: none
seed: 1
"""
PLANES = {
    "speed": {"loop": "speed", "p": "[0.1 1/s, 3 1/s]", "d": "[0, 1]"},
    "distance": {"loop": "gap", "p": "[0.01 1/s2, 0.3 1/s2]", "d": "[0.1 1/s, 2 1/s]"},
}


@pytest.mark.parametrize(
    "plane", [pytest.param("speed", marks=pytest.mark.thorough), pytest.param("distance", marks=pytest.mark.nightly)]
)
def test_160_runs_find_the_boundary_of_the_gains_as_exactly_as_a_grid_of_625(dse_in, example, tmp_path, plane):
    """Pass, fail and not exercised, of both requirements together, at the 1,600 points of a finer grid."""
    root = shutil.copytree(example, tmp_path / "work")

    def explored(name, sampler, levels=2):
        text = STUDY % {**PLANES[plane], "sampler": sampler, "levels": levels}
        (root / "testbenches" / "gains.pet.yaml").write_text(text, encoding="utf-8")
        done = dse_in(root, "explore", "gains", "-o", str(tmp_path / name), "--workers", "1")
        assert done.returncode == 0, done.stderr
        loop = PLANES[plane]["loop"]
        columns = [f'"p:controller.kp_{loop}"', f'"p:controller.kd_{loop}"']
        columns += [f"""iif("verdict:{r}" = 'not exercised', NULL, "margin:{r}")""" for r in ("R1", "R2")]
        with closing(sqlite3.connect(tmp_path / name / "study.sqlite")) as connection:
            rows = connection.execute(f"SELECT {', '.join(columns)} FROM runs ORDER BY number").fetchall()  # noqa: S608
        table = np.array(rows, dtype=np.float64)
        return table[:, :2], {"R1": table[:, 2], "R2": table[:, 3]}

    points, margins = explored("fine", "full_factorial", 40)
    low, width = points.min(axis=0), np.ptp(points, axis=0)
    fine, true = (points - low) / width, classes(margins)
    found, theirs = explored("found", "{boundary: {samples: 160}}")
    assert len(found) == len(np.unique(found, axis=0)) == 160
    _, coarse = explored("coarse", "full_factorial", 25)
    by_search = np.mean(predicted((found - low) / width, theirs, fine) != true)
    by_grid = np.mean(classes({name: interpolated(column, fine) for name, column in coarse.items()}) != true)
    assert by_search <= by_grid
    assert by_search < 0.015


def interpolated(margins, fine):
    """Of a grid of 25 by 25, linearly; where most of what is near is not exercised, it is not either."""
    line, grid = np.linspace(0, 1, 25), margins.reshape(25, 25)
    inside = RegularGridInterpolator((line, line), np.where(np.isnan(grid), -1.0, 1.0))(fine)
    near = RegularGridInterpolator((line, line), np.nan_to_num(grid))(fine)
    return np.where(inside < 0, np.nan, near)
