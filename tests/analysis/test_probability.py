from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from known_functions import even, study, variable
from scipy.stats import binom

from dse.analysis import (
    ALL,
    Basis,
    Topic,
    best_boxes,
    essentials,
    model_first_order_shares,
    probability_met,
    robust_centre,
    share_met,
    study_data,
    wilson,
)
from dse.domain.definition import DefinedSampler
from dse.errors import DseError
from dse.storage import RunTable

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
    with pytest.raises(DseError, match="R1: no run shows whether it is met: 9 runs do not exercise it, 0 failed"):
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


def _crowded(first: int) -> RunTable:
    """Of a disc of area 0.503: *first* random runs, and 100 near its edge, where a search put them."""
    random = np.random.default_rng(0)
    angle, radius = 2 * np.pi * random.random(100), 0.36 + 0.08 * random.random(100)
    rim = 0.5 + np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    points = np.concatenate([random.random((first, 2)), rim])
    table = study(points, {"r": np.hypot(*(points - 0.5).T)}, {"r": 0.4}, sampler=DefinedSampler("boundary"))
    return replace(table, header=replace(table.header, first=first))


def test_runs_near_the_boundary_are_no_sample_of_the_space_but_say_where_it_is():
    met = share_met(study_data(_crowded(16)))
    assert met.basis is Basis.MODEL
    assert met.share.low < np.pi * 0.16 < met.share.high
    assert met.share.high - met.share.low < 0.05
    (text,) = [each.text for each in essentials(_crowded(16)) if each.topic is Topic.MET]
    assert text == "R1: met in 50 % (50 … 51 %) of the space (by a model of the verdicts through 116 runs)"


def test_what_a_model_does_not_know_is_a_share_of_the_runs_that_were_drawn_evenly():
    """Of noise; where these are few as well, nothing is said, and no index, box or centre either."""
    points = even(200, 2)
    noise = study(points, {"y": np.random.default_rng(1).random(200)}, {"y": 0.5}, sampler=DefinedSampler("nsga2"))
    some, few = (study_data(replace(noise, header=replace(noise.header, first=count))) for count in (60, 16))
    met = share_met(some)
    assert (met.basis, met.judged) == (Basis.EVEN_RUNS, 60)
    assert met.share.low < 0.5 < met.share.high
    with pytest.raises(DseError, match="R1: 'nsga2' did not place its runs evenly over the space, and by a model"):
        share_met(few, "R1")
    for withheld in (lambda: model_first_order_shares(few, "y"), lambda: best_boxes(few), lambda: robust_centre(few)):
        with pytest.raises(DseError, match="16 of the 200 runs of 'nsga2' are drawn evenly"):
            withheld()


@pytest.mark.parametrize(
    ("kind", "options", "counts"), [("csv", {}, 0), ("csv", {"even": True}, 9), ("gone", {}, 0), ("sobol", {}, 9)]
)
def test_a_sampler_declares_which_runs_are_drawn_evenly(kind, options, counts):
    table = study(even(9, 1), {"y": np.zeros(9)}, sampler=DefinedSampler(kind, options))
    assert study_data(table).even.sum() == counts


def test_runs_of_an_earlier_sampler_are_drawn_evenly_if_the_present_one_asks_for_them_again():
    table = study(even(9, 1), {"y": np.zeros(9)})
    extended = replace(table.header, base=4, earlier=4, era=1)
    assert study_data(replace(table, header=extended)).even.all()
    assert study_data(replace(table, header=replace(extended, asked=7))).even.tolist() == [False] * 4 + [True] * 5


def test_a_model_judges_designs_at_the_worst_of_their_conditions():
    """x1 + load / 2 is to be at most 0.7, and counts for loaded ones only: met where x1 is at most 0.2; with another
    requirement, that x1 is at least 0.1 if empty, in half of that."""
    x1, load = even(60, 1)[:, 0], np.arange(60) % 2.0
    variables = [variable("x1"), variable("load", values=(0.0, 1.0), role="condition")]
    metrics = {"y": np.where(load > 0, x1 + 0.5, np.nan), "z": np.where(load > 0, np.nan, 0.1 - x1)}
    for bounds, share in (({"y": 0.7}, 0.2), ({"y": 0.7, "z": 0.0}, 0.1)):
        sampler = DefinedSampler("boundary")
        table = study(np.column_stack([x1, load]), metrics, bounds, variables=variables, sampler=sampler)
        met = share_met(study_data(table), ALL)
        assert (met.conditions, met.share.value) == (2, pytest.approx(share, abs=0.02))


def test_constraints_between_variables_are_no_crowding():
    """The half of x1 + x2 < 0.8 where x1 + x2 < 0.4 is a quarter of it, whatever lies beyond; by the model as well."""
    points = even(1500, 2)
    points = points[points.sum(axis=1) < 0.8]
    for kind in ("sobol", "boundary"):
        table = study(points[:100], {"y": points[:100].sum(axis=1)}, {"y": 0.4}, sampler=DefinedSampler(kind))
        definition = replace(table.header.definition, constraints=("x1 + x2 < 0.8",))
        met = share_met(study_data(replace(table, header=replace(table.header, definition=definition))))
        assert met.share.low < 0.25 < met.share.high


def test_runs_that_share_their_values_tell_less_than_as_many_others():
    """40 designs under 5 conditions each: nothing depends on the condition, so that each counts once."""
    design, fog = np.repeat(even(40, 1)[:, 0], 5), np.tile(np.linspace(0.0, 1.0, 5), 40)
    variables = [variable("x1"), variable("fog", values=tuple(np.linspace(0.0, 1.0, 5).tolist()), role="condition")]
    table = study(np.column_stack([design, fog]), {"y": design}, {"y": 0.5}, variables=variables)
    met = probability_met(study_data(table), "R1")
    assert met.judged == 200
    assert met.counts_as == pytest.approx(40.0)
