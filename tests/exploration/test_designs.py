"""Runs as designs: feasible or not, and what they come to at the worst condition."""

from __future__ import annotations

import numpy as np
import pytest
from design_cases import AT_MOST, DESIGN_CASES
from hypothesis import given, strategies as st

from dse.domain.bench import Verdict
from dse.domain.sampler import DesignVariable, Objective, Outcomes, Role
from dse.exploration.designs import designs_of, front_of, violations
from dse.units import DIMENSIONLESS

P, F, N, X = Verdict.PASS, Verdict.FAIL, Verdict.NOT_EXERCISED, Verdict.FAILED_TO_RUN
GAIN = DesignVariable("a.k", 0.0, 1.0, 2, 0.0, DIMENSIONLESS)
ROAD = DesignVariable("b.slope", 0.0, 1.0, 2, 0.0, DIMENSIONLESS, role=Role.CONDITION)
MASS = DesignVariable("c.mass", 0.0, 9.0, 0, 5.0, DIMENSIONLESS, role=Role.UNCERTAIN)
USE = Objective("use")


def outcomes(*runs: tuple[str, float, float, float, float, Verdict, float]) -> Outcomes:
    """Runs as configuration, gain, slope, mass, use, verdict, margin."""
    names, gain, slope, mass, use, verdicts, margins = zip(*runs, strict=True)
    done = np.array([verdict is not X for verdict in verdicts])
    points = {"a.k": np.array(gain), "b.slope": np.array(slope), "c.mass": np.array(mass)}
    totals = {"cost": np.array([{"x": 7.0, "y": 5.0}[name] for name in names])}
    return Outcomes(
        names, points, done, {"use": np.array(use)}, {"R": np.array(margins)}, {"R": tuple(verdicts)}, totals
    )


def one(*runs: tuple[str, float, float, float, float, Verdict, float], objectives: tuple[Objective, ...] = (USE,)):
    designs = designs_of(outcomes(*runs), (GAIN, ROAD, MASS), objectives)
    assert len(designs) == 1
    return designs


def test_an_objective_is_the_mean_over_what_is_uncertain_at_the_worst_condition():
    runs = [("x", 0.5, slope, mass, use, P, 0.1) for slope, mass, use in ((0, 4, 1), (0, 6, 3), (1, 4, 2), (1, 6, 4))]
    assert one(*runs).objectives.tolist() == [[3.0]]
    assert one(*runs, objectives=(Objective("use", maximize=True),)).objectives.tolist() == [[2.0]]
    assert one(*runs, objectives=(Objective("cost", is_total=True),)).objectives.tolist() == [[7.0]]


@pytest.mark.parametrize(
    ("verdicts", "feasible"),
    [((P, P), True), ((P, N), True), ((N, N), False), ((P, F), False), ((P, X), False), ((X, X), False)],
)
def test_a_design_is_feasible_if_it_was_shown_to_meet_everything_and_failed_nothing(verdicts, feasible):
    runs = [("x", 0.5, float(i), 5.0, 1.0, v, np.nan if v is X else 0.1) for i, v in enumerate(verdicts)]
    designs = one(*runs)
    assert designs.feasible.tolist() == [feasible]
    assert (violations(designs, np.ones(1)) == 0).tolist() == [feasible]


def test_the_smallest_margin_is_that_of_a_run_that_exercised_the_requirement():
    runs = [("x", 0.5, 0.0, 5.0, 1.0, N, -9.0), ("x", 0.5, 1.0, 5.0, 1.0, P, 0.2), ("x", 0.5, 1.0, 6.0, 1.0, P, 0.1)]
    assert one(*runs).margins.tolist() == [[0.1]]


def test_a_run_that_failed_leaves_the_objective_undefined():
    designs = one(("x", 0.5, 0.0, 5.0, np.nan, X, np.nan), ("x", 0.5, 1.0, 5.0, 1.0, P, 0.2))
    assert np.isnan(designs.objectives).all()
    assert designs.failed.tolist() == [1]


def test_a_condition_at_which_no_design_has_a_value_does_not_count():
    at_one = [("x", 0.5, 1.0, 5.0, 2.0, P, 0.2), ("y", 0.5, 1.0, 5.0, 3.0, P, 0.2)]
    at_none = [(name, 0.5, 0.0, 5.0, np.nan, P, 0.2) for name in "xy"]
    for sense in (USE, Objective("use", maximize=True)):
        found = designs_of(outcomes(*at_one, *at_none), (GAIN, ROAD, MASS), (sense,)).objectives
        assert found.tolist() == [[2.0], [3.0]]
    undefined = ("y", 0.5, 0.0, 5.0, 1.0, P, 0.2)
    assert np.isnan(designs_of(outcomes(*at_one, at_none[0], undefined), (GAIN, ROAD, MASS), (USE,)).objectives[0])


def test_designs_stand_in_the_order_of_their_first_runs():
    runs = [("y", 0.5, 0, 5, 1, P, 1), ("x", 0.2, 0, 5, 1, P, 1), ("y", 0.5, 1, 5, 1, P, 1), ("y", 0.1, 0, 5, 1, P, 1)]
    designs = designs_of(outcomes(*runs), (GAIN, ROAD, MASS))
    assert designs.configurations == ("y", "x", "y")
    assert designs.points.tolist() == [[0.5], [0.2], [0.1]]
    assert [rows.tolist() for rows in designs.rows] == [[0, 2], [1], [3]]


def test_what_misses_more_violates_more_and_a_failed_run_most():
    misses = [("x", gain, 0.0, 5.0, 1.0, F, margin) for gain, margin in ((0.1, -0.0), (0.2, -0.5), (0.3, -1.0))]
    told = [*misses, ("x", 0.4, 0.0, 5.0, 1.0, X, np.nan), ("x", 0.5, 0.0, 5.0, 1.0, P, 1.0)]
    found = violations(designs_of(outcomes(*told), (GAIN, ROAD, MASS)), np.ones(1))
    assert 0 < found[0] < found[1] < found[2] < found[3]
    assert found[4] == 0


@given(st.lists(st.tuples(*[st.sampled_from([0.0, 1.0, 2.0, 3.0, np.nan])] * 3), max_size=25))
def test_the_front_is_what_nothing_dominates(points):
    objectives = np.array(points).reshape(len(points), 3)

    def is_better(one, other):
        return bool((one <= other).all() and (one < other).any())

    expected = [
        not np.isnan(own).any() and not any(is_better(other, own) for other in objectives) for own in objectives
    ]
    assert front_of(objectives).tolist() == expected


@pytest.mark.parametrize("case", DESIGN_CASES)
def test_every_case_is_judged_as_the_report_judges_it(case):
    words = [X if not run.done else N if not run.exercised else P if run.value <= AT_MOST else F for run in case.runs]
    margins = [AT_MOST - run.value for run in case.runs]
    told = [
        ("x", 0.5, run.condition, run.draw, run.value, word, margin)
        for run, word, margin in zip(case.runs, words, margins, strict=True)
    ]
    # Another design has a value at each condition.
    other = [("y", 0.5, run.condition, 5.0, 1.0, P, 0.1) for run in case.runs]
    designs = designs_of(outcomes(*told, *other), (GAIN, ROAD, MASS), (USE,))
    assert designs.feasible[0] == (case.verdict == "pass")
    assert (designs.failed[0] > 0) == (case.verdict == "failed to run")
    assert designs.margins[0, 0] == pytest.approx(case.margin, nan_ok=True)
    assert designs.objectives[0, 0] == pytest.approx(case.objective, nan_ok=True)
