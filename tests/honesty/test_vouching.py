"""What a component says of how exact its FMU is."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from dse.errors import DseError
from dse.testbench.study import bench_study, prepare_study
from honesty.cases import CASES
from honesty.workspace import lay_out


@pytest.mark.parametrize(
    ("says", "problem"),
    [
        (", sampled: 0 s", "component.yaml:3:55: the sample time must be positive, not 0 s"),
        (", sampled: 3 m", "component.yaml:3:55: "),
        (", sampled: 30 ms", "samples every 0.03 s, no multiple of the step 0.02 s"),
        (", exact: perhaps", "component.yaml:3:53: "),
    ],
)
def test_what_nobody_can_vouch_for_is_refused(tmp_path: Path, says: str, problem: str):
    case = CASES["exact, as is said"]
    case = replace(case, parts={"part": replace(case.parts["part"], says=says)})
    with pytest.raises(DseError) as caught:
        prepare_study(bench_study(lay_out(case, tmp_path).bench("bench")))
    assert problem in str(caught.value)


def test_what_is_vouched_for_is_not_tried(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))
    told: list[str] = []
    workspace = lay_out(CASES["source, as is said"], tmp_path)
    ((_, prepared),) = prepare_study(bench_study(workspace.bench("bench")), say=told.append).benches.items()
    assert told == []
    assert [variation.step for variation in prepared.checks.variations] == [0.5, 1 / 3]
    assert math.isclose(prepared.timeout, (1 + 2 + 3) * 60.0)
