"""A study that looks for rare failures, from the file to the sentence, against a closed form."""

from __future__ import annotations

import json
import math
import re

import pytest
from command_line import run_dse
from rated_cars import FILES
from workspaces import written

from dse.analysis.failures import failure_findings
from dse.storage import StudyFolder

BENCH = (
    FILES["testbenches/wall.yaml"]
    + "requirements: {R1: {title: soft impact, metric: impact_speed, at_most: 24 km/h}}\n"
)
STUDY = """\
study: rare
testbench: wall
uncertain:
  target.host_speed: {title: speed, normal: {mean: 60 km/h, sd: 3 km/h}}
  target.speed: {normal: {mean: 10 km/h, sd: 2 km/h}}
sampler: {rare_failures: {batch: 100, last: 300}}
keep_waveforms: none
seed: 3
"""


@pytest.mark.thorough
def test_the_share_that_fails_is_stated_with_an_interval_and_the_mildest_failure(tmp_path):
    folder = written(tmp_path / "w", {**FILES, "testbenches/wall.yaml": BENCH, "testbenches/rare.pet.yaml": STUDY})
    done = run_dse(folder, "explore", "rare", cache=tmp_path / "cache")
    assert done.returncode == 0, done.stderr
    assert "R1 (soft impact): fails in 0." in run_dse(folder, "findings", "out/rare", cache=tmp_path / "cache").stdout
    told = run_dse(folder, "findings", "out/rare", "--format", "json", cache=tmp_path / "cache")
    found = next(each for each in json.loads(told.stdout) if each["topic"] == "share that fails")
    assert found["about"] == "R1"
    # The brake takes off 35 km/h: the impact is above 24 km/h if the closing speed, N(50, 3^2 + 2^2), is above 59.
    share = math.erfc(9 / math.sqrt(3**2 + 2**2) / math.sqrt(2)) / 2
    assert found["facts"]["share"]["low"] < share < found["facts"]["share"]["high"]
    assert found["facts"]["share"]["high"] < 1.5 * found["facts"]["share"]["low"]
    # The mildest is near the point of the limit that is nearest to the means, at 9 / sqrt(13) standard deviations.
    speed, target = map(float, re.findall(r"speed (\d+\.\d+) km/h", found["text"]))
    away = math.hypot((speed - 60) / 3, (target - 10) / 2)
    assert 9 / math.sqrt(13) - 0.01 < away < 9 / math.sqrt(13) + 0.2
    with StudyFolder.open(folder / "out" / "rare") as store:
        (withheld,) = failure_findings(store.table(range(300)))
    assert withheld.topic == "withheld"
    assert "100 runs that the search asked for are missing" in withheld.text  # those of the fourth batch
    assert "all 716 runs were there" in run_dse(folder, "explore", "rare", cache=tmp_path / "cache").stdout
