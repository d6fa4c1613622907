from __future__ import annotations

import sys

import numpy as np
import pytest
from known_functions import even, ishigami, study, variable

from dse.analysis import Topic, essentials, findings
from dse.domain.definition import DefinedSampler


def _texts(found, topic):
    return [each.text for each in found if each.topic is topic]


def _plane(count, seed=0, **facts):
    """y = x1 + x2 / 4 is required to be at most 0.5."""
    points = even(count, 2, seed)
    return study(points, {"y": points[:, 0] + points[:, 1] / 4}, {"y": 0.5}, **facts)


def test_what_was_learnt_is_said():
    found = essentials(_plane(800))
    (met,) = _texts(found, Topic.MET)
    (box, *_) = _texts(found, Topic.BOX)
    (centre,) = _texts(found, Topic.CENTRE)
    (share,) = _texts(found, Topic.SHARES)
    assert met.startswith("R1: met in 3")
    assert met.endswith(" of the space (estimated from 800 runs)")
    assert box.startswith("R1: met if x1 < 0.")
    assert centre.startswith("R1: most may change around run ")
    assert share.startswith("y: x1 9")
    assert _texts(found, Topic.WITHHELD) == []


def test_what_is_looked_for_next_is_told():
    told: list[str] = []
    found = findings(_plane(100), told.append)
    assert told[0] == "how often it is met of R1"
    assert "a box of R1" in told
    assert found == findings(_plane(100))


def test_a_study_of_which_a_third_failed_says_so_and_counts_none_as_met():
    """All that ran meet the requirement; runs fail where x1 > 0.7. Nothing is 100 % of the space, nothing is 0."""
    points = even(600, 2)
    done = points[:, 0] <= 0.7
    metrics = {"y": points[:, 1], "late": np.where(points[:, 1] > 0.5, points[:, 1], np.nan), "same": np.ones(600)}
    found = findings(study(points, metrics, {"y": 2.0}, done=done))
    failed = int((~done).sum())
    assert _texts(found, Topic.RUNS) == [f"{failed} of 600 runs failed to run: they meet nothing and have no metrics"]
    (met,) = _texts(found, Topic.MET)
    assert met.startswith(f"R1: met in {600 - failed} of {600 - failed} runs (at least 99")
    assert met.endswith(f"; {failed} failed to run")
    (box,) = _texts(found, Topic.BOX)
    assert box.startswith("R1: met if x1 < 0.7")
    late = next(text for text in _texts(found, Topic.SHARES) if text.startswith("late"))
    defined = int((done & (points[:, 1] > 0.5)).sum())
    assert late.startswith(f"late where it is defined ({defined} of 600 runs): x2 9")
    assert "what explains the variance of same: it is the same in every run in which it is defined" in _texts(
        found, Topic.WITHHELD
    )


@pytest.mark.parametrize("count", [0, 1, 2, 5])
def test_few_runs_say_little_and_why(count):
    found = findings(_plane(count))
    told = _texts(found, Topic.WITHHELD)
    assert not _texts(found, Topic.BOX) + _texts(found, Topic.SHARES) + _texts(found, Topic.TOGETHER)
    if count:
        assert any(text.startswith("a box of R1: ") for text in told)
        assert any("40 are needed" in text for text in told)
    else:
        assert _texts(found, Topic.RUNS) == ["there are no runs in the ranges of the study"]


@pytest.mark.thorough
def test_a_study_without_requirements_tells_what_matters():
    points = even(100, 2)
    found = findings(study(points, {"y": points[:, 0]}))
    assert {each.topic for each in found} == {Topic.SHARES, Topic.TOGETHER}


def test_a_study_of_choices_only_has_counts_and_no_intervals():
    """What was run is all there is: no sample of a space."""
    choices = [{"sensor": sensor, "brake": brake} for sensor in "abcd" for brake in "xyz"]
    y = np.array([choice["sensor"] in "ab" for choice in choices]) * 1.0
    (met,) = _texts(essentials(study(np.zeros((12, 0)), {"y": y}, {"y": 0.5}, choices=choices)), Topic.MET)
    assert met == "R1: met in 6 of 12 runs"


def test_slices_are_told_apart():
    """Each plane of two variables, the others held at 0.5, has sentences of its own."""
    axis = np.linspace(0.0, 1.0, 11)
    grid = np.array([(one, other) for one in axis for other in axis])
    held = np.full((121, 2), 0.5)
    points = np.unique(np.concatenate([np.hstack([grid, held]), np.hstack([held, grid])]), axis=0)
    slices = (("x1", "x2"), ("x3", "x4"))
    sampler = DefinedSampler("full_factorial", {"slices": [list(s) for s in slices]}, slices)
    found = essentials(study(points, {"y": points[:, 0] - points[:, 2]}, {"y": 0.25}, sampler=sampler))
    assert dict.fromkeys(each.plane for each in found) == dict.fromkeys(slices)
    shares = {each.plane: each.text for each in found if each.topic is Topic.SHARES}
    assert shares[slices[0]].startswith("y: x1 ")
    assert shares[slices[1]].startswith("y: x3 ")
    assert "falling" in shares[slices[1]]


def test_the_worst_condition_is_told():
    gain, fog = (axis.ravel() for axis in np.meshgrid(np.linspace(0, 1, 9), [10.0, 20.0, 40.0], indexing="ij"))
    fogs = variable("fog", unit="m", low=10.0, high=40.0, values=(10.0, 20.0, 40.0), role="condition")
    table = study(np.column_stack([gain, fog]), {"y": gain - fog / 40}, {"y": 0.2}, variables=[variable("gain"), fogs])
    (text,) = _texts(essentials(table), Topic.CONDITIONS)
    assert text.startswith("R1: worst at fog = 10 m, met there in 44 % (")
    assert "; 4 of 9 designs meet it at all conditions" in text


def test_values_are_told_in_their_units():
    points = even(300, 1) * 50
    table = study(points, {"y": points[:, 0]}, {"y": 25.0}, variables=[variable("speed", unit="km/h", high=50.0)])
    (box,) = _texts(essentials(table), Topic.BOX)
    assert box.startswith("R1: met if speed < 9")
    assert " km/h: in " in box


def test_findings_need_no_extra(monkeypatch):
    for name in [name for name in sys.modules if name.split(".")[0] in ("sklearn", "SALib")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "sklearn", None)
    monkeypatch.setitem(sys.modules, "SALib", None)
    points = even(200, 3)
    assert {each.topic for each in findings(study(points, {"y": ishigami(points)}))} == {Topic.SHARES, Topic.TOGETHER}
