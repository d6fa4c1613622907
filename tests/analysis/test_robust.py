from __future__ import annotations

import numpy as np
import pytest
from known_functions import even, study, variable

from dse.analysis import robust_centre, study_data, worst_case
from dse.errors import DseError


def _grid(levels: int) -> np.ndarray:
    axis = np.linspace(0.0, 1.0, levels)
    return np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)


def test_the_robust_centre_is_in_the_middle_of_what_passes():
    """A square of 0.3 … 0.9 by 0.1 … 0.7 passes: from its middle it is 0.3 to its sides."""
    points = _grid(21)
    distance = np.abs(points - [0.6, 0.4]).max(axis=1)
    data = study_data(study(points, {"y": distance}, {"y": 0.301}))
    found = robust_centre(data, "R1")
    assert data.places[data.numbers == found.number][0] == pytest.approx([0.6, 0.4], abs=0.06)
    assert found.margin == pytest.approx(0.3, abs=0.05)
    assert found.around > 50
    assert found.share.value > 0.95
    assert distance[found.limit] == pytest.approx(0.35)


def test_the_end_of_a_range_limits_what_is_known():
    points = _grid(11)
    found = robust_centre(study_data(study(points, {"y": np.zeros(121)}, {"y": 1.0})), "R1")
    assert (found.margin, found.limit) == (pytest.approx(0.5, abs=0.11), -1)


@pytest.mark.parametrize("seed", range(4))
def test_noise_has_no_robust_centre(seed):
    points = even(300, 2, seed)
    data = study_data(study(points, {"y": np.random.default_rng(seed).random(300)}, {"y": 0.6}))
    with pytest.raises(DseError, match="around the best point"):
        robust_centre(data)


def test_failed_and_not_exercised_runs_are_no_place_to_be_near_of():
    points = _grid(21)
    done, exercised = points[:, 0] < 0.625, points[:, 1] < 0.825
    table = study(points, {"y": np.zeros(441)}, {"y": 1.0}, done=done, exercised=exercised)
    data = study_data(table)
    found = robust_centre(data, "R1")
    assert data.places[data.numbers == found.number][0, 0] == pytest.approx(0.3, abs=0.06)


def test_margins_are_measured_between_runs_of_the_same_choices():
    points = np.concatenate([_grid(11), _grid(11)])
    choices = [{"sensor": "lidar"}] * 121 + [{"sensor": "radar"}] * 121
    y = np.array([choice["sensor"] == "radar" for choice in choices]) * 1.0
    found = robust_centre(study_data(study(points, {"y": y}, {"y": 0.5}, choices=choices)), "R1")
    assert (found.margin, found.limit) == (pytest.approx(0.5, abs=0.11), -1)


def test_a_design_that_fails_under_a_condition_has_no_margin():
    """x1 is decided, x2 a condition: y = x1 + x2 is within 1.2 for all of x2 only where x1 is at most 0.2."""
    points = _grid(21)
    variables = [variable("x1"), variable("x2", role="condition")]
    data = study_data(study(points, {"y": points.sum(axis=1)}, {"y": 1.2001}, variables=variables))
    found = robust_centre(data, "R1")
    assert data.places[data.numbers == found.number][0, 0] == pytest.approx(0.1, abs=0.06)
    assert found.margin == pytest.approx(0.1, abs=0.05)


def test_designs_that_all_fail_under_a_condition_have_no_centre():
    points = _grid(11)
    variables = [variable("x1"), variable("x2", role="condition")]
    data = study_data(study(points, {"y": points[:, 1]}, {"y": 0.5}, variables=variables))
    with pytest.raises(DseError, match="at another condition"):
        robust_centre(data, "R1")


@pytest.mark.parametrize(("count", "bound", "why"), [(1, 1.0, "no number differs"), (2, 1.0, "1 held-out run,")])
def test_few_runs_have_no_robust_centre(count, bound, why):
    points = np.linspace(0.4, 0.6, count).reshape(-1, 1)
    with pytest.raises(DseError, match=why):
        robust_centre(study_data(study(points, {"y": np.zeros(count)}, {"y": bound})), "R1")


def test_without_a_passing_run_there_is_no_centre():
    with pytest.raises(DseError, match="R1: no run meets it"):
        robust_centre(study_data(study(even(50, 2), {"y": np.ones(50)}, {"y": 0.5})), "R1")


def test_the_worst_condition_and_the_designs_that_pass_under_all_are_found():
    """y = gain + fog is at most 1 under every fog (0, 0.25, 0.5) for gains up to 0.5; run 0 … 2 are of the gain 0."""
    gain, fog = (axis.ravel() for axis in np.meshgrid(np.linspace(0, 1, 5), [0.0, 0.25, 0.5], indexing="ij"))
    variables = [variable("gain"), variable("fog", values=(0.0, 0.25, 0.5), high=0.5, role="condition")]
    data = study_data(study(np.column_stack([gain, fog]), {"y": gain + fog}, {"y": 1.0}, variables=variables))
    found = worst_case(data, "fog", "R1")
    assert [each.met.met for each in found.conditions] == [5, 4, 3]
    assert data.factors[1].value(found.worst.place) == 0.5
    assert (found.complete, found.passing, found.incomplete, found.best) == (5, 3, 0, 2)


def test_designs_that_lack_a_condition_are_counted_neither_way():
    gain, fog = np.array([0.0, 0.0, 1.0, 0.5, 0.5]), np.array([0.0, 1.0, 0.0, 0.0, 1.0])
    done = [True, True, True, True, False]
    data = study_data(study(np.column_stack([gain, fog]), {"y": np.zeros(5)}, {"y": 1.0}, done=done))
    found = worst_case(data, "x2", "R1")
    assert (found.complete, found.passing, found.incomplete) == (2, 1, 1)


def test_a_condition_under_which_nothing_is_judged_is_not_the_worst():
    points = np.array([[x, fog] for x in (0.0, 1.0) for fog in (0.0, 1.0)])
    table = study(points, {"y": np.zeros(4)}, {"y": 1.0}, exercised=points[:, 1] < 0.5)
    found = worst_case(study_data(table), "x2", "R1")
    assert found.conditions[1].met is None
    assert found.worst.place == 0.0
    # It is met where it is exercised, as `Designs.feasible` has it.
    assert found.passing == 2


def test_values_of_a_continuum_are_no_conditions():
    data = study_data(study(even(50, 2), {"y": np.zeros(50)}, {"y": 1.0}))
    with pytest.raises(DseError, match="x1: it has 50 values"):
        worst_case(data, "x1", "R1")
