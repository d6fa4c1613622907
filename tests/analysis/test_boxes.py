from __future__ import annotations

import numpy as np
import pytest
from known_functions import even, study, variable

from dse.analysis import best_boxes, study_data
from dse.analysis.phrases import condition
from dse.errors import DseError


def _limits(box):
    return {limit.factor.name: (limit.low, limit.high) for limit in box.limits}


def _noisy_box(seed: int, count: int = 1000):
    """x1 > 0.6 and x2 < 0.4 pass in nine of ten runs, the others in one of twenty; x3 and x4 do nothing."""
    points = even(count, 4, seed)
    random = np.random.default_rng(seed + 1000)
    inside = (points[:, 0] > 0.6) & (points[:, 1] < 0.4)
    passes = random.random(count) < np.where(inside, 0.9, 0.05)
    return study(points, {"y": np.where(passes, 0.0, 2.0)}, {"y": 1.0})


def test_a_known_box_is_found_in_noise():
    """Limits within 0.06: some ten of 1,000 runs lie between."""
    (box,) = best_boxes(study_data(_noisy_box(0)), "R1")
    assert set(_limits(box)) == {"x1", "x2"}
    assert _limits(box)["x1"][0] == pytest.approx(0.6, abs=0.06)
    assert _limits(box)["x2"][1] == pytest.approx(0.4, abs=0.06)
    assert box.density.low <= 0.9 <= box.density.high
    assert box.coverage == pytest.approx(0.16 * 0.9 / (0.16 * 0.9 + 0.84 * 0.05), abs=0.12)


@pytest.mark.thorough
def test_a_known_box_is_found_in_the_noise_of_every_study():
    found = [best_boxes(study_data(_noisy_box(seed)), "R1")[0] for seed in range(50)]
    assert all({"x1", "x2"} <= set(_limits(box)) for box in found)
    assert np.median([abs(_limits(box)["x1"][0] - 0.6) for box in found]) < 0.03
    assert np.median([abs(_limits(box)["x2"][1] - 0.4) for box in found]) < 0.03
    held = [box.density.low <= 0.9 <= box.density.high for box in found]
    assert sum(held) >= 43


def test_two_boxes_are_found_one_after_the_other():
    points = even(1500, 2)
    first = (points[:, 0] < 0.4) & (points[:, 1] < 0.5)
    second = (points[:, 0] > 0.7) & (points[:, 1] > 0.5)
    one, other = best_boxes(study_data(study(points, {"y": 1.0 - (first | second)}, {"y": 0.5})), "R1")
    assert _limits(one)["x1"][1] == pytest.approx(0.4, abs=0.03)
    assert _limits(other)["x1"][0] == pytest.approx(0.7, abs=0.03)
    assert one.coverage + other.coverage > 0.95


def test_pure_chance_is_no_box():
    """Passes that depend on nothing: of 20 studies none has a box, though each has corners with more passes."""
    for seed in range(20):
        points = even(300, 4, seed)
        chance = np.random.default_rng(seed).random(300)
        assert best_boxes(study_data(study(points, {"y": chance}, {"y": 0.3})), "R1") == ()


def test_runs_that_failed_or_did_not_exercise_it_do_not_meet_it():
    """All are within the bound; those with x1 < 0.3 fail to run, those with x2 < 0.3 do not exercise it."""
    points = even(1000, 3)
    done, exercised = points[:, 0] >= 0.3, points[:, 1] >= 0.3
    table = study(points, {"y": np.zeros(1000)}, {"y": 1.0}, done=done, exercised=exercised)
    (box,) = best_boxes(study_data(table), "R1")
    assert {name: round(limits[0], 1) for name, limits in _limits(box).items()} == {"x1": 0.3, "x2": 0.3}
    assert box.density.value == 1.0


def test_choices_are_limited_by_naming_them():
    random = np.random.default_rng(0)
    sensors = random.choice(["camera", "lidar", "radar"], size=400)
    table = study(
        even(400, 1), {"y": (sensors == "camera") * 1.0}, {"y": 0.5}, choices=[{"sensor": str(s)} for s in sensors]
    )
    (box,) = best_boxes(study_data(table), "R1")
    assert condition(box.limits) == "sensor is not camera"
    assert box.density.value == box.coverage == 1.0


def test_limits_are_told_in_the_units_of_the_variables():
    speed, gain = (axis.ravel() for axis in np.meshgrid(np.arange(21), np.arange(21)))
    variables = [variable("lead.speed", unit="km/h", high=50.0), variable("k", unit="1/s", high=0.5)]
    y = ((speed > 10) | (gain > 10)) * 1.0
    table = study(np.column_stack([speed * 2.5, gain * 0.025]), {"y": y}, {"y": 0.5}, variables=variables)
    (box,) = best_boxes(study_data(table), "R1")
    assert condition(box.limits) == "lead.speed < 94.5 km/h and k < 0.263 1/s"


def test_whether_a_factor_is_there_is_for_its_choice_to_say():
    """Runs without x2 all pass; with it, those where it is below 0.4."""
    points = even(600, 2)
    choices = [{"controller": "plain" if number % 2 else "tuned"} for number in range(600)]
    points[1::2, 1] = np.nan
    table = study(points, {"y": np.nan_to_num(points[:, 1])}, {"y": 0.4}, choices=choices)
    (box,) = best_boxes(study_data(table), "R1")
    assert condition(box.limits).startswith("x2 < 0.")
    assert condition(box.limits).endswith(" (where it is there)")
    assert box.coverage > 0.95


def test_values_are_told_as_those_that_are_in():
    values = (10.0, 20.0, 40.0, 80.0)
    column = np.random.default_rng(0).choice(values, size=400)
    table = study(
        np.column_stack([column, even(400, 1)[:, 0]]),
        {"y": column},
        {"y": 30.0},
        variables=[variable("gap", unit="m", low=10.0, high=80.0, values=values), variable("x2")],
    )
    (box,) = best_boxes(study_data(table), "R1")
    assert condition(box.limits) == "gap is 10 m or 20 m"


@pytest.mark.parametrize(
    ("count", "bound", "why"),
    [
        (1, 0.5, "1 runs are too few for a box"),
        (5, 0.5, "5 runs are too few for a box"),
        (200, 0.01, "runs meet it, too few for a box"),
        (200, 0.99, "nearly all runs meet it"),
    ],
)
def test_no_box_is_refused_with_its_reason(count, bound, why):
    points = even(count, 2)
    with pytest.raises(DseError, match=why):
        best_boxes(study_data(study(points, {"y": points[:, 0]}, {"y": bound})), "R1")
