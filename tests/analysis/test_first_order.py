from __future__ import annotations

import numpy as np
import pytest
from known_functions import ISHIGAMI, even, g_function, g_indices, ishigami, study, variable

from dse.analysis import aliased, going_together, interacting, main_effects, model_first_order_shares, study_data
from dse.analysis.dependence import shares
from dse.analysis.importance import _dependent
from dse.analysis.separable import folds
from dse.errors import DseError


def _shares(table, metric="y"):
    return {each.factor: each.share for each in model_first_order_shares(study_data(table), metric)}


def test_indices_of_ishigami_come_from_random_runs():
    """Within 0.06: three standard deviations of the estimate at 1,000 runs, 0.024 at most over 100 seeds, less bins."""
    points = even(1000, 3)
    found = _shares(study(points, {"y": ishigami(points)}))
    for name, (first, _) in ISHIGAMI.items():
        assert found[name].value == pytest.approx(first, abs=0.06)
        assert found[name].low <= first <= found[name].high


def test_indices_of_the_g_function_come_from_random_runs():
    points = even(2000, 4)
    found = _shares(study(points, {"y": g_function(points)}))
    for (first, _), share in zip(g_indices(), found.values(), strict=True):
        assert share.value == pytest.approx(first, abs=0.06)


@pytest.mark.thorough
def test_intervals_hold_the_published_indices_in_nine_of_ten_studies():
    """Bins are too wide for few runs, which costs up to a twentieth of the second index: not 95 % for each of them."""
    held = []
    for seed in range(100):
        points = even(1000, 3, seed)
        found = _shares(study(points, {"y": ishigami(points)}))
        held.append([found[name].low <= first <= found[name].high for name, (first, _) in ISHIGAMI.items()])
    assert (np.mean(held, axis=0) >= 0.87).all()


@pytest.mark.thorough
def test_more_runs_come_closer_to_the_published_indices():
    errors = []
    for count in (250, 4000):
        points = [even(count, 3, seed) for seed in range(20)]
        found = [_shares(study(each, {"y": ishigami(each)})) for each in points]
        errors.append(max(abs(np.mean([f[n].value for f in found]) - ISHIGAMI[n][0]) for n in ISHIGAMI))
    assert errors[1] < 0.005 < errors[0]


def test_a_factor_that_does_nothing_has_no_share():
    points = even(300, 2)
    assert _shares(study(points, {"y": points[:, 0]}))["x2"].low == 0.0
    assert _shares(study(points, {"y": points[:, 0]}))["x2"].value < 0.02


def test_choices_have_shares_too():
    random = np.random.default_rng(0)
    sensor = random.integers(3, size=400)
    y = np.array([0.0, 5.0, 1.0])[sensor] + random.normal(size=400)
    table = study(np.zeros((400, 0)), {"y": y}, choices=[{"sensor": "abc"[each], "video": "on"} for each in sensor])
    (share,) = model_first_order_shares(study_data(table), "y")
    means = np.array([0.0, 5.0, 1.0])
    assert share.factor == "sensor"
    assert share.share.value == pytest.approx(means.var() / (means.var() + 1), abs=0.05)


def test_runs_that_crowd_count_by_the_space_around_them():
    """Nine of ten runs lie in a corner in which nothing happens: the share is that over the whole square."""
    random = np.random.default_rng(0)
    points = np.concatenate([0.2 * random.random((900, 2)), random.random((400, 2))])
    y = (points[:, 0] > 0.5) * (1.0 + (points[:, 1] > 0.5))
    truth = (1.5**2 / 4) / (1.25 - 0.75**2)
    assert _shares(study(points, {"y": y}))["x1"].value == pytest.approx(truth, abs=0.05)


@pytest.mark.parametrize("count", [0, 1, 2, 5])
def test_few_runs_have_no_shares(count):
    points = even(count, 2)
    with pytest.raises(DseError, match=f"y: it is defined in {count} of {count} runs, and 40 are needed"):
        model_first_order_shares(study_data(study(points, {"y": points[:, 0]})), "y")


def test_a_constant_metric_has_no_shares():
    with pytest.raises(DseError, match="y: it is the same in every run in which it is defined"):
        model_first_order_shares(study_data(study(even(50, 2), {"y": np.full(50, 1e6)})), "y")


def test_an_unknown_metric_is_refused_by_its_name():
    with pytest.raises(DseError, match="no metric 'z'"):
        model_first_order_shares(study_data(study(even(50, 2), {"y": even(50, 1)[:, 0]})), "z")


def test_a_choice_of_one_level_is_no_factor():
    table = study(even(50, 1), {"y": even(50, 1)[:, 0]}, choices=[{"sensor": "lidar"}] * 50)
    assert [factor.name for factor in study_data(table).factors] == ["x1"]


def test_an_absent_variable_is_judged_by_the_runs_that_have_it():
    """Half of the runs lack x2; where it is there, it is all that counts."""
    points, is_there = even(400, 2), np.arange(400) % 2 == 0
    y = np.where(is_there, points[:, 1], 0.5)
    points[~is_there, 1] = np.nan
    shares = {each.factor: each for each in model_first_order_shares(study_data(study(points, {"y": y})), "y")}
    assert shares["x2"].runs == 200
    assert shares["x2"].share.value > 0.95


def test_a_logarithmic_variable_is_even_on_its_scale():
    points = 10.0 ** (3 * even(500, 1))
    table = study(points, {"y": np.log10(points[:, 0])}, variables=[variable("x1", low=1.0, high=1000.0, scale="log")])
    assert study_data(table).weights.max() == 1.0
    assert study_data(table).places.mean() == pytest.approx(0.5, abs=0.05)


def test_factors_that_go_together_are_told():
    points = even(300, 3)
    points[:, 1] = np.clip(points[:, 0] + 0.1 * points[:, 1], 0, 1)
    assert going_together(study_data(study(points, {}))) == (("x1", "x2"),)


def _twins(y, numbers=None):
    """Of two sensors that always have the same tracker, and a brake that has either."""
    kinds = np.arange(80) % 2, np.arange(80) // 2 % 2
    choices = [
        {"sensor": "ab"[kind], "tracker": "xy"[kind], "brake": "no"[brake]} for kind, brake in zip(*kinds, strict=True)
    ]
    return study_data(study(np.zeros((80, 0)) if numbers is None else numbers, {"y": y(*kinds)}, choices=choices))


def test_factors_that_always_change_together_have_no_shares_and_no_means():
    data = _twins(lambda kind, brake: 2.0 * kind + brake)
    assert aliased(data) == (("sensor", "tracker"),)
    assert [each.factor for each in model_first_order_shares(data, "y")] == ["brake"]
    assert [each.factor for each in main_effects(data, "y")] == ["brake"]


def test_the_finding_names_the_factors_that_cannot_be_separated():
    (finding,) = shares(_twins(lambda kind, brake: 2.0 * kind + brake), "y")
    assert "; sensor and tracker always change together in these runs" in finding.text
    assert "interactions or noise" not in finding.text


def test_where_all_factors_change_together_the_reason_is_given_instead():
    choices = [{"sensor": "ab"[at % 2], "tracker": "xy"[at % 2]} for at in range(80)]
    data = study_data(study(np.zeros((80, 0)), {"y": np.arange(80) % 2.0}, choices=choices))
    with pytest.raises(DseError, match="y: sensor and tracker always change together"):
        list(shares(data, "y"))


def test_one_at_a_time_and_a_half_fraction_confound_only_what_they_do():
    # A 2^(4-1) fraction with D = ABC: no two main effects agree; with D = -A two do.
    a, b, c = (np.array(np.meshgrid([0.0, 1], [0.0, 1], [0.0, 1])).reshape(3, -1)).repeat(10, axis=1)
    fraction = np.stack([a, b, c, (a + b + c) % 2], axis=1)
    assert aliased(study_data(study(fraction, {"y": a}))) == ()
    assert aliased(study_data(study(np.stack([a, b, c, 1 - a], axis=1), {"y": a}))) == (("x1", "x4"),)
    single = 0.5 + 0.3 * np.concatenate([np.zeros((1, 3)), np.eye(3)]).repeat(10, axis=0)
    assert aliased(study_data(study(single, {"y": single[:, 0]}))) == ()


def _fraction(y):
    """A 2^(3-1) fraction with C = AB as choices, at two grades of a brake; each case is run ten times."""
    rows = [(a, b, a ^ b, d) for a in (0, 1) for b in (0, 1) for d in (0, 1)] * 10
    choices = [{"a": "no"[a], "b": "no"[b], "c": "no"[c], "brake": "no"[d]} for a, b, c, d in rows]
    return study_data(study(np.zeros((80, 0)), {"y": np.array([y(*row) for row in rows])}, choices=choices))


def test_an_interaction_is_not_credited_to_the_factor_that_is_aliased_with_it():
    data = _fraction(lambda a, b, c, brake: 3.0 * (a ^ b) + brake)  # c itself does nothing
    assert aliased(data) == ()
    assert interacting(data) == (("b", "c", "a"), ("a", "c", "b"), ("a", "b", "c"))
    assert [each.factor for each in model_first_order_shares(data, "y")] == ["brake"]
    assert [each.factor for each in main_effects(data, "y")] == ["brake"]
    (finding,) = shares(data, "y")
    assert (
        "; c follows from a and b in these runs, so its effect cannot be separated from their interaction"
        in finding.text
    )
    names = [factor.name for factor in data.factors]
    assert [{names[k] for k in group} for group in _dependent(data)] == [{"a", "b", "c"}, {"brake"}]


def test_what_follows_from_one_factor_or_is_crossed_with_all_is_in_no_interaction():
    rows = [(a, b, c) for a in range(3) for b in range(2) for c in range(2)] * 5
    whole = [{"a": "xyz"[a], "b": "no"[b], "c": "no"[c]} for a, b, c in rows]
    values = {"y": np.arange(60.0)}
    assert interacting(study_data(study(np.zeros((60, 0)), values, choices=whole))) == ()
    # A class of a alone.
    coarse = [{"a": "xyz"[a], "b": "no"[b], "kind": "no"[a == 2]} for a, b, _ in rows]
    assert interacting(study_data(study(np.zeros((60, 0)), values, choices=coarse))) == ()
    # Of two of four combinations nothing is known.
    some = [{"a": "no"[a % 2], "b": "no"[a % 2], "c": "no"[c]} for a, _, c in rows]
    assert interacting(study_data(study(np.zeros((60, 0)), values, choices=some))) == ()
    # Each run has a value of its own.
    points = even(64, 3)
    assert interacting(study_data(study(points, {"y": points[:, 0]}))) == ()


def test_random_samples_at_several_conditions_are_not_aliased():
    points = np.concatenate([even(30, 2).repeat(2, axis=0), np.tile([[0.0], [1.0]], (30, 1))], axis=1)
    assert aliased(study_data(study(points, {"y": points[:, 0]}))) == ()


def at_configurations(points, y, count=5):
    """Each of *points* at each of so many configurations, which add what *y* gives for them."""
    places = np.repeat(points, count, axis=0)
    sensors = np.tile(np.arange(count), len(points))
    return study(places, {"y": y(places, sensors)}, choices=[{"sensor": f"s{each}"} for each in sensors])


def test_a_point_at_several_configurations_is_one_observation():
    points = even(80, 2)
    alone = _shares(study(points, {"y": points[:, 0]}))
    together = _shares(at_configurations(points, lambda x, _: x[:, 0]))
    assert together["x1"].value == pytest.approx(alone["x1"].value)
    assert together["x1"].low == pytest.approx(alone["x1"].low)
    assert together["sensor"].value == 0.0
    # Configurations that explain half of the variance leave half of it to the points.
    scale = np.std(points[:, 0]) / np.std([0, 1, 2, 3, 4])
    half = _shares(at_configurations(points, lambda x, sensor: x[:, 0] + scale * sensor))
    assert half["x1"].value == pytest.approx(alone["x1"].value / 2, abs=0.01)  # at most its total by a model
    assert half["sensor"].value == pytest.approx(0.5, abs=0.01)


def test_few_points_at_many_configurations_have_no_shares():
    """Of 16 points at 5 configurations, both variables seemed to explain 82 % of a metric (43 to 100 %)."""
    data = study_data(at_configurations(even(16, 2), lambda x, sensor: x[:, 0] + 0.2 * sensor))
    assert [each.factor for each in model_first_order_shares(data, "y")] == ["sensor"]
    (finding,) = shares(data, "y")
    assert finding.text.endswith("; there are 16 different values of x1 and x2 in these runs, and 40 are needed")
    effect = next(each for each in main_effects(data, "y") if each.factor == "x1")
    assert sum(effect.runs) == 80
    # Two points a bin: Student's t with one degree of freedom.
    first = effect.means[0]
    inside = sorted(even(16, 2)[:, 0])[:2]
    assert first.value == pytest.approx(np.mean(inside) + 0.4)
    assert first.high - first.value == pytest.approx(12.706 * np.ptp(inside) / 2, rel=1e-4)


def test_runs_at_one_point_judge_nothing_that_was_found_of_others_at_it():
    few, many = (study_data(at_configurations(even(count, 2), lambda x, _: x[:, 0])) for count in (9, 16))
    assert np.array_equal(many.points, np.repeat(np.arange(16), 5))
    assert len({*zip(many.points, many.half(), strict=True)}) == 16
    assert many.half().sum() == 40
    assert len({*zip(many.points, folds(many.points), strict=True)}) == 16
    assert len({*few.points}) == len(few) == 45  # too few points for halves of them


def test_levels_in_all_combinations_are_no_sample():
    load = [variable("gain"), variable("load", values=(0.0, 1.0), role="condition")]
    gains = np.linspace(0, 1, 80)
    points = np.array([(gain, each) for gain in gains for each in (0.0, 1.0)])
    found = _shares(study(points, {"y": points[:, 1]}, variables=load))
    assert found["load"].value == pytest.approx(1.0)


@pytest.mark.thorough
def test_intervals_hold_the_indices_where_points_are_at_several_configurations():
    held = []
    for seed in range(100):
        found = _shares(at_configurations(even(200, 3, seed), lambda x, _: ishigami(x)))
        held.append([found[name].low <= first <= found[name].high for name, (first, _) in ISHIGAMI.items()])
    # The second index loses to wide bins (see above); as runs they were held in fewer than half of the studies.
    assert (np.mean(held, axis=0) >= [0.87, 0.8, 0.87]).all()
