"""Studies side by side."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from served_studies import store_study

import dse
from dse.api import compare, comparison_as_data, flip_counts
from dse.errors import DseError


@pytest.fixture
def pair(tmp_path: Path) -> tuple[Path, Path]:
    """The second has one run more, one that came right and one that went wrong."""
    first = store_study(tmp_path / "first", [0.5, 1.5, math.nan])
    return first, store_study(tmp_path / "second", [1.25, 1.5, 0.5, 0.5])


def test_verdicts_that_flipped_are_those_of_runs_with_the_same_configuration_and_point(pair) -> None:
    first, second = compare(pair)
    assert (first.shared, first.flips, first.changed) == (3, (), ())
    assert (second.finished, second.shared) == (4, 3)
    assert [(flip.numbers, *map(str, flip.verdicts)) for flip in second.flips] == [
        ((0, 0), "pass", "fail"),
        ((2, 2), "failed to run", "pass"),
    ]
    flip = second.flips[0]
    assert (flip.requirement, flip.configuration, flip.point) == ("R1", "c1", {"controller.kp": 0.1})
    assert flip.margins == (0.5, -0.25)
    assert [*flip_counts(second).values()] == [1, 1]


def test_counts_are_those_of_each_study(pair) -> None:
    counts = [each.verdicts["R1"] for each in compare(pair)]
    assert counts[0] == {"pass": 1, "fail": 1, "not exercised": 0, "failed to run": 1}
    assert counts[1] == {"pass": 2, "fail": 2, "not exercised": 0, "failed to run": 0}


def test_a_comparison_is_plain_data(pair) -> None:
    data = json.loads(json.dumps(comparison_as_data(compare(pair)), allow_nan=True))
    assert data[1]["flips"][0]["verdicts"] == ["pass", "fail"]
    assert data[1]["study"] == "gains"


def test_a_study_by_itself_is_not_compared(pair) -> None:
    with pytest.raises(DseError, match="two studies or more"):
        compare(pair[:1])


def test_a_value_that_is_fixed_in_one_study_and_varied_in_the_other_is_the_same_value(
    results: dse.Results, ws: dse.Workspace, tmp_path: Path
) -> None:
    run = results.run(3)
    alone = ws.benches["acc_following"].noun
    from dataclasses import replace

    from dse.api.studies.bench import Study
    from dse.domain.study import Selection
    from dse.testbench import bench_study, with_values

    fixed = bench_study(with_values(alone, run.point), Selection((run.configuration,)))
    Study.of(replace(fixed, name="fixed")).explore(tmp_path / "fixed", workers=1)
    _, other = compare([results.folder, tmp_path / "fixed"])
    assert (other.finished, other.shared, other.flips) == (1, 1, ())
    assert any(change.startswith("design variable") for change in other.changed)


@pytest.mark.thorough
def test_a_requirement_that_changed_is_told_with_its_bounds(
    results: dse.Results, ws: dse.Workspace, tmp_path: Path
) -> None:
    from dataclasses import replace

    from dse.api.studies.bench import Study

    study = ws.studies["small"].noun
    looser = tuple(replace(each, at_most=10.0) if each.name == "R1" else each for each in study.bench.requirements)
    changed = replace(study, bench=replace(study.bench, requirements=looser))
    Study.of(changed).explore(tmp_path / "looser", workers=1)
    _, other = compare([results.folder, tmp_path / "looser"])
    (change,) = other.changed
    assert change.startswith("requirement R1: speed_overshoot ≤ 0.1 %")
    assert " became speed_overshoot ≤ 1000 %" in change
    assert other.shared == 6
    assert all(flip.requirement == "R1" and str(flip.verdicts[1]) == "pass" for flip in other.flips)
