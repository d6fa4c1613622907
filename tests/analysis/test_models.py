from __future__ import annotations

import numpy as np
import pytest
from known_functions import ISHIGAMI, even, ishigami, study

from dse.analysis import (
    courses,
    importances,
    main_effects,
    study_data,
)
from dse.errors import DseError


def _data(count, function, width=2, seed=0, **facts):
    points = even(count, width, seed)
    return study_data(study(points, {"y": function(points)}, **facts))


@pytest.mark.thorough
def test_importance_counts_what_factors_do_together():
    """Within 0.12 of the total indices: the forest predicts nine tenths of the variance, not all."""
    found = importances(_data(1500, ishigami, 3), "y")
    assert found.explained > 0.85
    for each, (_, total) in zip(found.factors, ISHIGAMI.values(), strict=True):
        assert each.share.value == pytest.approx(total, abs=0.12)
    assert found.factors[2].share.low > 0.05


@pytest.mark.thorough
def test_what_two_factors_do_only_together_is_told_of_the_pair():
    """Of (x1 - 1/2)(x2 - 1/2) nothing is due to either alone, and all to both: totals and the pair's share are 1."""
    found = importances(_data(400, lambda points: (points[:, 0] - 0.5) * (points[:, 1] - 0.5), 3), "y")
    assert [each.share.value for each in found.factors] == pytest.approx([1, 1, 0], abs=0.15)
    first, *others = found.pairs
    assert (first.one, first.other) == ("x1", "x2")
    assert first.share.low > 0.6
    assert max(pair.share.value for pair in others) < 0.1


@pytest.mark.thorough
def test_factors_that_go_together_have_one_total():
    points = even(300, 3)
    points[:, 1] = points[:, 0]
    found = importances(study_data(study(points, {"y": points[:, 0] + points[:, 2]})), "y")
    assert found.factors[0].share == found.factors[1].share
    assert {(pair.one, pair.other) for pair in found.pairs} == {("x1", "x3"), ("x2", "x3")}


def test_importance_of_what_many_runs_do_not_define_is_withheld():
    points = even(300, 2)
    y = np.where(points[:, 0] < 0.7, points[:, 1], np.nan)
    with pytest.raises(DseError, match=r"y: it is defined in 198 of 300 runs only"):
        importances(study_data(study(points, {"y": y})), "y")


def test_importance_of_runs_at_few_points_is_withheld():
    points = np.repeat(even(20, 2), 10, axis=0)
    with pytest.raises(DseError, match="variables have 20 different values in all: 50 are needed"):
        importances(study_data(study(points, {"y": points[:, 0]})), "y")


@pytest.mark.thorough
def test_importance_of_what_cannot_be_predicted_is_withheld():
    data = _data(200, lambda points: np.random.default_rng(1).random(len(points)))
    with pytest.raises(DseError, match="too little to say what matters together with others"):
        importances(data, "y")


@pytest.mark.thorough
def test_importance_bears_absent_factors():
    points = even(300, 2)
    points[::2, 1] = np.nan
    found = importances(study_data(study(points, {"y": 3 * points[:, 0] + np.nan_to_num(points[:, 1])})), "y")
    assert found.factors[0].share.value > 0.6


COURSES = {
    "rising": lambda x: np.exp(9 * x),
    "falling": lambda x: -np.tanh(20 * x - 10),
    "with a peak": lambda x: -((x - 0.4) ** 2),
    "with a valley": lambda x: np.abs(x - 0.5),
    "up and down": lambda x: np.sin(2 * np.pi * x),
    "": lambda x: 0 * x,
}


@pytest.mark.parametrize("course", COURSES)
@pytest.mark.parametrize(("count", "studies"), [(300, 5), pytest.param(100, 30, marks=pytest.mark.thorough)])
def test_a_course_is_that_of_the_function(course, count, studies):
    """With noise of half its range, uniform, it is told in nine tenths of the studies."""
    told = []
    for seed in range(studies):
        points = even(count, 2, seed)
        y = COURSES[course](points[:, 0])
        noise = np.random.default_rng(seed).uniform(-0.5, 0.5, count) * 0.5 * (np.ptp(y) or 1)
        told.append(courses(study_data(study(points, {"y": y + noise})), "y").get("x1", ""))
    assert told.count(course) >= 0.9 * studies


def test_main_effects_are_means_along_a_factor():
    first, second = main_effects(_data(800, lambda points: 4 * points[:, 0]), "y")
    assert [each.value for each in first.means] == pytest.approx(list(4 * np.array(first.at)))
    assert first.runs == (100,) * 8
    assert sum(each.low < 2.0 < each.high for each in second.means) >= 6


def test_a_mean_of_one_run_has_no_interval():
    effects = main_effects(study_data(study(np.arange(4.0).reshape(-1, 1) / 3, {"y": np.arange(4.0)})), "y")
    assert [each.value for each in effects[0].means] == [0.0, 1.0, 2.0, 3.0]
    assert np.isnan([each.low for each in effects[0].means]).all()


@pytest.mark.thorough
def test_a_forest_predicts_tree_by_tree_what_it_predicts():
    from sklearn.ensemble import RandomForestRegressor

    from dse.analysis.importance import _predict

    points = even(200, 3)
    points[::7, 1] = np.nan
    forest = RandomForestRegressor(12, max_features=0.7, random_state=0).fit(points, points[:, 0])
    assert (_predict(forest)(points)[:, 0] == forest.predict(points)).all()
