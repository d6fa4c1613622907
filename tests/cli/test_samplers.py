"""Samplers as a user has them: by YAML, stored, resumed, reported and extended."""

from __future__ import annotations

import re
import shutil

import pytest
from example_study import small_study

POINTS = "controller.kp_speed [1/s],controller.kd_speed\n0.75,0.25\n2.5,0.5\n"


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("{sobol: {samples: 2}}", "{sobol: {samples: 4}}"),
        pytest.param("{halton: {samples: 2}}", "{halton: {samples: 4}}", marks=pytest.mark.nightly),
        pytest.param("{boundary: {samples: 2}}", "{boundary: {samples: 4}}", marks=pytest.mark.thorough),
        pytest.param("{csv: {file: points.csv}}", "{csv: {file: more.csv}}", marks=pytest.mark.thorough),
        pytest.param("{latin_hypercube: {samples: 2}}", "{latin_hypercube: {samples: 4}}", marks=pytest.mark.nightly),
        pytest.param("{sobol: {samples: 2}}", "{halton: {samples: 2}}", marks=pytest.mark.nightly),
    ],
)
def test_a_sampler_is_found_stored_resumed_reported_and_extended(dse_in, example, tmp_path, before, after):
    root, out = shutil.copytree(example, tmp_path / "work"), tmp_path / "out"
    benches = root / "testbenches"
    (benches / "points.csv").write_text(POINTS, encoding="utf-8")
    (benches / "more.csv").write_text(POINTS + "1.5,0\n4.5,1\n", encoding="utf-8")

    def explore(sampler):
        text = small_study(5, 4).replace("full_factorial", sampler)
        (benches / "small.pet.yaml").write_text(text, encoding="utf-8")
        done = dse_in(root, "explore", "small", "-o", str(out), "--workers", "1")
        assert done.returncode == 0, done.stderr
        # Other tests may have made the same runs.
        return re.sub(", [0-9]+ made before and taken from the cache", "", done.stdout.splitlines()[0])

    def table():
        return dse_in(root, "results", str(out)).stdout.splitlines()

    assert explore(before).endswith("out: 2 runs, 2 of them new")
    assert explore(before).endswith("out: all 2 runs were there")
    first = table()
    assert explore(after).endswith("out: 4 runs, 2 of them new; the study was extended, its 2 runs are kept")
    assert table()[:3] == first
    assert explore(after).endswith("out: all 4 runs were there")
    assert dse_in(root, "report", str(out)).stdout.endswith("MB\n")
    replayed = dse_in(root, "replay", str(out), "3")
    assert "bit for bit" in replayed.stderr
