from __future__ import annotations

import numpy as np
import pytest
from known_functions import even, study, variable
from scipy.stats import binom

from dse.analysis import ALL, Topic, essentials, probability_met, study_data, wilson
from dse.errors import DseError

REPEATS = 1000


def _coverage(share: float, runs: int) -> float:
    """How often the interval holds the true share, exactly: the sum over all numbers of passes."""
    passes = np.arange(runs + 1)
    held = [wilson(k, runs).low <= share <= wilson(k, runs).high for k in passes.tolist()]
    return float(binom.pmf(passes, runs, share)[held].sum())


@pytest.mark.parametrize(
    ("share", "runs"), [(0.5, 50), (0.5, 400), (0.2, 50), (0.2, 400), (0.05, 200), (0.95, 200), (0.01, 1000)]
)
def test_intervals_hold_the_truth_in_95_of_100_studies(share, runs):
    """Exactly, where n p and n (1 - p) are 10 or more; passes come in whole numbers, so not 95.0."""
    assert 0.93 <= _coverage(share, runs) <= 0.97


@pytest.mark.thorough
@pytest.mark.parametrize(("share", "runs"), [(0.5, 400), (0.2, 100), (0.9, 200)])
def test_a_thousand_studies_have_intervals_that_hold_the_truth(share, runs):
    """From runs to the interval; 0.93 … 0.97 is three standard deviations of 1,000 repeats to either side."""
    held = 0
    for seed in range(REPEATS, 2 * REPEATS):
        points = even(runs, 1, seed)
        met = probability_met(study_data(study(points, {"y": points[:, 0]}, {"y": share})), "R1")
        held += met.share.low <= share <= met.share.high
    assert 0.93 <= held / REPEATS <= 0.97


def test_with_hardly_a_pass_expected_the_interval_holds_less_often_for_some_shares():
    """Wilson's limit near 0 and 1, known since Brown, Cai and DasGupta 2001: of 50 runs, p = 0.0036 is held in 84 %."""
    assert min(_coverage(share, 50) for share in np.linspace(0.0005, 0.01, 40).tolist()) < 0.9
    assert min(_coverage(share, 50) for share in np.linspace(0.1, 0.9, 40).tolist()) > 0.92


def test_runs_that_do_not_exercise_it_or_fail_are_told_apart_and_never_met():
    points = even(100, 1)
    exercised, done = np.arange(100) >= 20, np.arange(100) < 70
    table = study(points, {"y": np.zeros(100)}, {"y": 1.0}, exercised=exercised, done=done)
    met = probability_met(study_data(table), "R1")
    assert (met.met, met.failed, met.not_exercised, met.failed_to_run) == (50, 0, 20, 30)
    assert met.share.high == 1.0
    assert met.share.low == pytest.approx(50 / (50 + 1.959964**2))


def test_no_run_that_exercises_it_is_no_probability():
    table = study(even(9, 1), {"y": np.zeros(9)}, {"y": 1.0}, exercised=np.zeros(9, dtype=np.bool_))
    with pytest.raises(DseError, match="R1: no run says whether it is met: 9 runs do not exercise it, 0 failed"):
        probability_met(study_data(table), "R1")


def test_what_does_not_exercise_a_requirement_does_not_meet_all():
    points = even(500, 2)
    exercised = points[:, 0] < 0.3
    table = study(points, {"a": points[:, 0], "b": points[:, 1]}, {"a": 1.0, "b": 0.5}, exercised=exercised)
    assert probability_met(study_data(table), "R1").share.value == 1.0
    assert probability_met(study_data(table), ALL).share.value == (exercised & (points[:, 1] <= 0.5)).mean()
    text = next(each.text for each in essentials(table) if each.about == ALL and each.topic is Topic.MET)
    assert text == "all requirements: met in 11 % (9 … 14 %) of the space (estimated from 500 runs)"


def test_without_a_requirement_there_is_no_probability():
    with pytest.raises(DseError, match="no requirement"):
        probability_met(study_data(study(even(5, 1), {"y": np.zeros(5)})))


def _crowded(seed: int, outermost: float = 0.44) -> np.ndarray:
    """40 random points and 160 near the edge of a disc of radius 0.4."""
    random = np.random.default_rng(seed)
    angle, radius = 2 * np.pi * random.random(160), 0.36 + (outermost - 0.36) * random.random(160)
    rim = 0.5 + np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    return np.concatenate([random.random((40, 2)), rim])


def test_runs_near_the_boundary_count_by_the_space_around_them():
    """A disc of area 0.503, with a wide ring around it in which hardly any run is."""
    points = _crowded(0)
    table = study(points, {"r": np.hypot(*(points - 0.5).T)}, {"r": 0.4})
    met = probability_met(study_data(table), "R1")
    assert met.share.low < np.pi * 0.16 < met.share.high
    assert met.counts_as < 100


def test_runs_that_crowd_on_one_side_of_the_boundary_are_no_share_of_the_space():
    """The cells of those at the rim reach across it: nine of ten runs are inside, and 0.7 of the volume."""
    points = _crowded(0, outermost=0.4)
    table = study(points, {"r": np.hypot(*(points - 0.5).T)}, {"r": 0.4})
    with pytest.raises(DseError, match="R1: 180 runs meet it and 20 do not, but they crowd on one side"):
        probability_met(study_data(table), "R1")


@pytest.mark.thorough
def test_intervals_of_runs_that_crowd_hold_the_truth_too():
    """More often than 95 of 100: close to the boundary a run tells more than one drawn anywhere. Few are refused."""
    held, refused = 0, 0
    for seed in range(100):
        points = _crowded(seed)
        try:
            met = probability_met(study_data(study(points, {"r": np.hypot(*(points - 0.5).T)}, {"r": 0.4})), "R1")
        except DseError:
            refused += 1
            continue
        held += met.share.low < np.pi * 0.16 < met.share.high
    assert refused <= 15
    assert held >= 0.95 * (100 - refused)


def test_runs_that_share_their_values_tell_less_than_as_many_others():
    """40 designs under 5 conditions each: nothing depends on the condition, so that each counts once."""
    design, fog = np.repeat(even(40, 1)[:, 0], 5), np.tile(np.linspace(0.0, 1.0, 5), 40)
    variables = [variable("x1"), variable("fog", values=tuple(np.linspace(0.0, 1.0, 5).tolist()), role="condition")]
    table = study(np.column_stack([design, fog]), {"y": design}, {"y": 0.5}, variables=variables)
    met = probability_met(study_data(table), "R1")
    assert met.judged == 200
    assert met.counts_as == pytest.approx(40.0)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_few_runs_have_wide_intervals(count):
    met = probability_met(study_data(study(even(count, 1), {"y": np.zeros(count)}, {"y": 1.0})), "R1")
    assert met.share.low < 0.6
    assert met.share.high == 1.0
