"""What the page is told of a study: by value against dse.analysis and closed forms."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

import numpy as np
import pytest
from known_functions import even, study, variable

from dse.analysis import (
    best_boxes,
    centres_of,
    essentials,
    evaluated,
    features,
    formulas,
    main_effects,
    model_first_order_shares,
    planes,
    robust_centre,
)
from dse.domain.definition import DefinedObjective, DefinedSampler
from dse.domain.method import Algorithm, Method
from dse.exploration import Band
from dse.report import insight_of
from dse.report.page.encoding import Block
from dse.report.page.payload import insight_json


def plane(count: int = 600, **facts):
    """y = x1 + x2 / 4 is required to be at most 0.5."""
    points = even(count, 2, 0)
    return study(points, {"y": points[:, 0] + points[:, 1] / 4}, {"y": 0.5}, **facts)


def with_objectives(table, *objectives):
    return replace(
        table, header=replace(table.header, definition=replace(table.header.definition, objectives=objectives))
    )


def test_sentences_are_those_of_the_analysis():
    table = plane()
    assert [each.text for each in insight_of(table).told] == [each.text for each in essentials(table)]


def test_titles_stand_for_the_paths_of_variables_and_for_nothing_else():
    points = even(200, 2, 0)
    variables = (variable("car.gain", title="the gain"), variable("car.gain2", title="another"))
    table = study(points, {"y": points[:, 0]}, {"y": 0.5}, variables=variables)
    told = " ".join(each.text for each in insight_of(table).told)
    assert "the gain" in told
    assert "car.gain" not in told
    assert "the gain2" not in told


def test_bars_and_effects_are_those_of_the_analysis():
    table = plane()
    (data,) = planes(table)
    (part,) = insight_of(table).parts
    (response,) = part.responses
    assert [bar.share for bar in response.bars] == [
        (each.share.value, each.share.low, each.share.high) for each in model_first_order_shares(data, "y")
    ]
    for effect, expected in zip(response.effects, main_effects(data, "y"), strict=True):
        assert effect.places == expected.at
        assert effect.means == tuple((mean.value, mean.low, mean.high) for mean in expected.means)


def test_totals_are_what_factors_do_with_others_included():
    """y = x1 x2 on a unit square has totals of 4/7 each and 1/7 that depends on both (by hand)."""
    points = even(600, 2, 0)
    table = study(points, {"y": points[:, 0] * points[:, 1], "z": np.random.default_rng(0).random(600)}, {"y": 0.3})
    known, noise = insight_of(table).parts[0].responses
    assert known.together is not None
    assert [bar.share[0] for bar in known.together.totals] == pytest.approx([4 / 7, 4 / 7], abs=0.06)
    (pair,) = known.together.pairs
    assert pair.share[0] == pytest.approx(1 / 7, abs=0.05)
    assert noise.together is None
    assert any("no requirement or objective is about it" in why for why in noise.withheld)


def test_the_ellipse_lies_around_the_robust_centre_where_all_is_met():
    insight = insight_of(plane(300))
    (around,) = insight.around
    assert around.run == insight.centres[0].run
    assert around.map.requirement == -1
    assert (around.map.passing == insight.chances[0].passing).all()
    outline = np.array(around.outline)
    assert (outline[:, 0] + outline[:, 1] / 4 < 0.55).all()
    assert np.ptp(outline[:, 1]) > 0.45


def test_boxes_and_the_robust_centre_are_those_of_the_analysis():
    table = plane()
    (data,) = planes(table)
    insight = insight_of(table)
    for box, expected in zip(insight.boxes, best_boxes(data, "R1"), strict=True):
        assert box.density[0] == expected.density.value
        assert box.coverage == expected.coverage
        rows = np.ones(len(data), dtype=bool)
        for limit in box.ranges:
            rows &= (data.places[:, limit.variable] >= limit.low) & (data.places[:, limit.variable] <= limit.high)
        assert (rows == expected.holds(data)).all()
    (centre,) = insight.centres
    found = robust_centre(data, "R1")
    assert (centre.run, centre.margin, centre.around) == (found.number, found.margin, found.around)
    for limits in centre.ranges:
        middle = data.places[data.numbers == found.number][0, limits.variable]
        assert (limits.low, limits.high) == pytest.approx((middle - found.margin, middle + found.margin))


def test_a_formula_of_a_plane_is_that_plane_and_says_that_it_errs_by_nothing():
    points = features(even(200, 2, 0), planes(plane(200))[0].factors)
    values = (3 + points @ np.array([1.0, -2.0]))[:, None]
    centres = centres_of(points)
    (formula,) = formulas(points, values, centres, np.arange(len(points)))
    there = np.array([[0.3, -0.9], [0.0, 0.0]])
    assert evaluated(there, centres, formula.weights[:, None], formula.power)[:, 0] == pytest.approx(
        [5.1, 3.0], abs=1e-3
    )
    assert formula.error < 1e-3
    assert formula.explained > 0.9999


def test_the_error_of_a_formula_is_what_it_errs_by_in_runs_it_has_never_seen():
    points = even(300, 2, 0)
    values = np.sin(7 * points[:, :1]) * points[:, 1:]
    centres = centres_of(points)
    (formula,) = formulas(points, values, centres, np.arange(len(points)))
    fresh = even(2000, 2, 5)
    wrong = evaluated(fresh, centres, formula.weights[:, None], formula.power) - np.sin(7 * fresh[:, :1]) * fresh[:, 1:]
    # It is made from a quarter more runs than those whose error is told, and errs more at the rim, beyond the last run.
    assert 0.5 * formula.error < np.sqrt((wrong**2).mean()) < 1.5 * formula.error


def test_noise_is_not_explained_by_any_formula():
    points = even(200, 2, 0)
    noise = np.random.default_rng(1).normal(size=200)
    (part,) = insight_of(study(points, {"y": noise}, {"y": 0.0})).parts
    assert part.responses[0].profile is not None
    assert part.responses[0].profile.explained < 0.1


def test_chances_are_those_of_the_band_at_the_places_of_the_map():
    table = plane(120)
    (found,) = insight_of(table).chances
    even_places = np.linspace(0, 1, found.size)
    points = np.stack([np.tile(even_places, found.size), np.repeat(even_places, found.size)], axis=1)
    expected = Band(table, "R1", "c0").at(points)
    assert np.abs(found.passing - 100 * expected.passing).max() <= 0.5001
    assert np.abs(found.misjudged - 100 * expected.misjudged).max() <= 0.5001
    assert found.uncertain == (expected.misjudged > 0.05).mean()
    surely = points[:, 0] + points[:, 1] / 4
    assert (found.passing[surely < 0.4] > 95).all()
    assert (found.passing[surely > 0.6] < 5).all()


def test_slices_are_told_apart_and_held_variables_are_not_factors():
    rows = np.linspace(0, 1, 9)
    grid = np.stack([np.tile(rows, 9), np.repeat(rows, 9)], axis=1)
    half = np.full((81, 2), 0.5)
    points = np.concatenate([np.hstack([grid, half]), np.hstack([half, grid])])
    sampler = DefinedSampler("full_factorial", {}, (("x1", "x2"), ("x3", "x4")))
    variables = [variable(f"x{k}", levels=9) for k in range(1, 5)]
    table = study(points, {"y": points @ [1.0, 0.5, 0.25, 2.0]}, {"y": 2.0}, variables=variables, sampler=sampler)
    insight = insight_of(table)
    assert [part.plane for part in insight.parts] == [(0, 1), (2, 3)]
    assert [[factor.variable for factor in part.factors] for part in insight.parts] == [[0, 1], [2, 3]]
    assert all(set(chance.plane) in ({0, 1}, {2, 3}) for chance in insight.chances)
    assert all(
        {variable for variable, _ in chance.held} == {0, 1, 2, 3} - set(chance.plane) for chance in insight.chances
    )


def test_the_search_ends_at_the_best_feasible_value_and_never_goes_back():
    points = even(200, 2, 0)
    table = study(points, {"y": points[:, 0], "z": points[:, 1]}, {"y": 0.5})
    search = insight_of(with_objectives(table, DefinedObjective("z"))).search
    assert search is not None
    best = points[points[:, 0] <= 0.5, 1].min()
    assert search.picks[0].values == (best,)
    assert search.picks[0].run == int(np.flatnonzero(points[:, 1] == best)[0])
    reached = [stage.best for stage in search.stages if stage.best == stage.best]
    assert reached == sorted(reached, reverse=True)
    assert reached[-1] == best


def test_of_several_objectives_the_volume_only_grows():
    points = even(200, 2, 0)
    table = study(points, {"y": points[:, 0], "z": points[:, 1]}, {"y": 0.9})
    search = insight_of(with_objectives(table, DefinedObjective("z"), DefinedObjective("y"))).search
    assert search is not None
    volumes = [stage.volume for stage in search.stages]
    assert volumes == sorted(volumes)
    assert volumes[-1] == 1.0


def test_of_a_method_is_told_what_is_not_plain():
    table = plane(2)
    definition = table.header.definition
    in_turn = asdict(Method(algorithm=Algorithm.GAUSS_SEIDEL))
    changed = replace(definition, simulation=replace(definition.simulation, method=in_turn))
    told = insight_of(replace(table, header=replace(table.header, definition=changed))).asked.sentences
    assert any(sentence.endswith(" s, algorithm gauss_seidel.") for sentence in told)


@pytest.mark.parametrize("count", [0, 1, 2, 12])
def test_few_runs_make_an_insight_that_says_what_is_missing(count):
    insight = insight_of(plane(count))
    assert insight.asked.sentences
    assert not insight.boxes
    if count:
        assert all(part.responses[0].withheld for part in insight.parts)


def test_a_study_in_which_all_runs_failed_tells_that():
    table = plane(60, done=np.zeros(60, dtype=bool))
    insight = insight_of(table)
    assert insight.told[0].text.startswith("60 of 60 runs failed to run")
    assert insight.parts[0].responses[0].profile is None
    assert not insight.chances


def test_without_the_extra_for_analysis_nothing_is_lost(monkeypatch):
    import sys

    table = plane()
    before = json.dumps(insight_json(insight_of(table), Block()))
    for module in [name for name in sys.modules if name.startswith(("sklearn", "SALib"))]:
        monkeypatch.setitem(sys.modules, module, None)
    for module in ("sklearn", "sklearn.ensemble", "SALib"):
        monkeypatch.setitem(sys.modules, module, None)
    assert json.dumps(insight_json(insight_of(table), Block())) == before


def test_the_same_runs_give_the_same_bytes():
    texts = []
    for _ in range(2):
        block = Block()
        texts.append(json.dumps(insight_json(insight_of(plane()), block), allow_nan=False) + block.text())
    assert texts[0] == texts[1]


def test_a_choice_is_a_factor_with_levels_and_no_variable():
    points = even(80, 1, 0)
    choices = [{"sensor": ("lidar", "radar")[i % 2]} for i in range(80)]
    values = points[:, 0] + np.arange(80) % 2
    (part,) = insight_of(study(points, {"y": values}, {"y": 1.0}, choices=choices)).parts
    choice = part.factors[1]
    assert (choice.title, choice.variable, choice.levels) == ("sensor", -1, ("lidar", "radar"))
    assert part.responses[0].profile is not None
    assert part.responses[0].profile.explained > 0.99
