"""A condition is no choice: designs are judged by the worst of their conditions, and a rule names choices alone."""

from __future__ import annotations

import numpy as np
import pytest
from known_functions import study, variable

from dse.analysis import Topic, best_boxes, essentials, probability_met, study_data, worst_designs
from dse.domain.bench import VERDICTS, Verdict
from dse.errors import DseError

PASS, FAIL, OPEN, FAILED = (
    VERDICTS.index(v) for v in (Verdict.PASS, Verdict.FAIL, Verdict.NOT_EXERCISED, Verdict.FAILED_TO_RUN)
)


def _crossed(*axes):
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def loads():
    """A gain of 0, 0.1 … 1 under loads of 0 and 0.4: gain + load is to be at most 0.65.

    Unloaded the seven gains up to 0.6 pass, loaded the three up to 0.2: 3 of 11 designs, not 10 of 22 runs.
    """
    points = _crossed(np.linspace(0, 1, 11), [0.0, 0.4])
    variables = [variable("gain"), variable("load", values=(0.0, 0.4), high=0.4, role="condition")]
    return study(points, {"y": points.sum(axis=1)}, {"y": 0.65}, variables=variables)


def weather():
    """A gain of 0, 0.025 … 1 and a place of two brakes, in fog or rain, on a slope or none.

    In fog y is 1 - gain, in rain gain, a drum adds 0.2 on a slope, 0.75 at most is asked for: a disc takes gains of
    0.25 … 0.75 (21 of 41), a drum 0.45 … 0.55 (5 of 41). 26 of 82 designs.
    """
    rows = _crossed([0.0, 1.0], np.linspace(0, 1, 41), [0.0, 1.0], [0.0, 1.0])
    drum, gain, rain, slope = rows.T
    y = np.where(rain == 1, gain, 1 - gain) + 0.2 * drum * slope
    variables = [
        variable("gain"),
        variable("sky", labels=("fog", "rain"), values=(0.0, 1.0), role="condition"),
        variable("slope", values=(0.0, 1.0), role="condition"),
    ]
    choices = [{"brake": "drum" if each else "disc"} for each in drum]
    return study(rows[:, 1:], {"y": y}, {"y": 0.7501}, variables=variables, choices=choices)


def two_requirements():
    """Each requirement is met by runs at one condition that the other fails there, and exercised there only.

    y = x at condition 0, z = 1 - x at condition 1, of x = 0, 0.1 … 1; y is to be at most 0.65, z at most 0.55, each
    where it is exercised. Both: x of 0.5 and 0.6, 2 of 11 designs; y alone 7, z alone 6.
    """
    points = _crossed(np.linspace(0, 1, 11), [0.0, 1.0])
    x, at = points.T
    variables = [variable("x"), variable("at", values=(0.0, 1.0), role="condition")]
    metrics = {"y": np.where(at == 0, x, np.nan), "z": np.where(at == 1, 1 - x, np.nan)}
    return study(points, metrics, {"y": 0.65, "z": 0.55}, variables=variables)


def pairs():
    """Twelve gains by nine rates, empty (0) and loaded (1): 0.2 + load / 2 - gain is to be at most 0.

    Of k / 11 the nine gains from 3 / 11 on pass empty, the four from 8 / 11 on loaded: 36 of 108 pairs, not 81.
    """
    points = _crossed(np.linspace(0, 1, 12), np.linspace(0, 1, 9), [0.0, 1.0])
    variables = [variable("gain"), variable("rate"), variable("load", values=(0.0, 1.0), role="condition")]
    return study(points, {"y": 0.2 + points[:, 2] / 2 - points[:, 0]}, {"y": 0.0}, variables=variables)


@pytest.mark.parametrize(("made", "passing", "designs"), [(loads, 3, 11), (weather, 26, 82), (pairs, 36, 108)])
def test_designs_are_counted_and_each_at_its_worst_condition(made, passing, designs):
    met = probability_met(worst_designs(study_data(made())), "R1")
    assert (met.met, met.judged) == (passing, designs)


def test_a_requirement_is_met_where_it_is_exercised_if_it_is_failed_nowhere():
    data = worst_designs(study_data(two_requirements()))
    counts = {name: int(data.met(name).sum()) for name in ("R1", "R2", "all requirements")}
    assert (len(data), counts) == (11, {"R1": 7, "R2": 6, "all requirements": 2})


def test_conditions_are_in_no_rule():
    found = essentials(pairs())
    (met,) = [each.text for each in found if each.topic is Topic.MET]
    (rule,) = [each.text for each in found if each.topic is Topic.BOX]
    assert met.startswith("R1: met at both conditions in ")
    assert "of the space (estimated from 36 of 108 designs" in met
    assert rule.startswith("R1: met at both conditions if gain > 0.682: in ")
    assert " held-out designs (" in rule


def test_a_condition_that_explains_a_metric_is_called_one():
    (share,) = [each.text for each in essentials(pairs()) if each.topic is Topic.SHARES]
    assert "load (condition) " in share


def test_the_run_that_decides_stands_for_the_design():
    """The worst is the loaded one: odd numbers; a run that failed to run goes before."""
    assert worst_designs(study_data(loads())).numbers.tolist() == list(range(1, 22, 2))
    points = _crossed([0.0, 1.0], [0.0, 1.0])
    variables = [variable("gain"), variable("load", values=(0.0, 1.0), role="condition")]
    table = study(points, {"y": points[:, 1]}, {"y": 2.0}, variables=variables, done=[False, True, True, True])
    data = worst_designs(study_data(table))
    assert data.numbers.tolist() == [0, 3]
    assert data.codes("R1").tolist() == [FAILED, PASS]


def test_a_design_that_lacks_a_condition_is_left_out_unless_it_failed_already():
    """Gains of 0, 1, 2 by 3: 0 at both loads, 1 passes at the only one it has, 2 fails at it."""
    points = np.array([[0.0, 0.0], [0.0, 1.0], [0.5, 0.0], [1.0, 0.0]])
    variables = [variable("gain"), variable("load", values=(0.0, 1.0), role="condition")]
    data = worst_designs(study_data(study(points, {"y": points[:, 0]}, {"y": 0.75}, variables=variables)))
    assert (data.numbers.tolist(), data.codes("R1").tolist(), data.incomplete) == ([0, 3], [PASS, FAIL], 1)


def test_runs_at_one_condition_each_do_not_judge_designs():
    points = np.column_stack([np.linspace(0, 1, 100), np.arange(100) % 2])
    variables = [variable("gain"), variable("load", values=(0.0, 1.0), role="condition")]
    data = study_data(study(points, {"y": points[:, 0]}, {"y": 0.5}, variables=variables))
    with pytest.raises(DseError, match="no design was run at all 2 conditions"):
        worst_designs(data)


def test_without_conditions_a_run_is_a_design():
    data = study_data(study(np.linspace(0, 1, 9)[:, None], {"y": np.zeros(9)}, {"y": 1.0}))
    assert worst_designs(data) is data


def test_a_box_is_looked_for_though_half_of_the_runs_has_few_that_meet_it():
    """16 of 168 runs meet it, all in one corner, and 7 of them are in the half that a box is made from."""
    points = _crossed(np.linspace(0, 1, 14), np.linspace(0, 1, 12))
    inside = (points[:, 0] > 0.7) & (points[:, 1] > 0.7)
    data = study_data(study(points, {"y": 1.0 - inside}, {"y": 0.5}))
    assert int(data.met("R1").sum()) == 16
    assert [limit.factor.name for limit in best_boxes(data, "R1")[0].limits] == ["x1", "x2"]
