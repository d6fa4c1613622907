from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from known_functions import study, variable

from dse.analysis import (
    around,
    around_designs,
    best_boxes,
    claim,
    objectives_of,
    of_box,
    ranked,
    study_data,
    unit_of_objective,
    what_would_change,
)
from dse.domain.definition import DefinedObjective, DefinedTotal
from dse.domain.sampler import Objective
from dse.errors import DseError

USE, COST = Objective("use"), Objective("cost", is_total=True)


def _table(*runs, **facts):
    """Runs as choice, gain, slope, use, slip; slip has to be at most 0.5, slope is a condition."""
    choices, gain, slope, use, slip = zip(*runs, strict=True)
    points = np.array([gain, slope], dtype=np.float64).T
    variables = [variable("gain"), variable("slope", role="condition", values=(0.0, 1.0))]
    metrics = {"use": np.array(use, dtype=np.float64), "slip": np.array(slip, dtype=np.float64)}
    return study(
        points, metrics, {"slip": 0.5}, variables=variables, choices=[{"motor": each} for each in choices], **facts
    )


def _priced(table, costs):
    definition = table.header.definition
    priced = tuple(
        replace(each, totals={"cost": DefinedTotal(costs[each.choices["motor"]], "EUR")})
        for each in definition.configurations
    )
    return replace(table, header=replace(table.header, definition=replace(definition, configurations=priced)))


RUNS = (
    ("small", 0.2, 0, 5.0, 0.1), ("small", 0.2, 1, 6.0, 0.2),
    ("small", 0.4, 0, 4.0, 0.3), ("small", 0.4, 1, 5.5, 0.4),
    ("large", 0.2, 0, 3.0, 0.1), ("large", 0.2, 1, 3.5, 0.8),
    ("large", 0.6, 0, 7.0, 0.1),
)  # fmt: skip


def test_designs_are_ranked_by_their_worst_condition_and_have_to_meet_everything():
    found = ranked(_table(*RUNS), [USE], 5)
    assert [(each.values, each.point) for each in found.best] == [((5.5,), {"gain": 0.4}), ((6.0,), {"gain": 0.2})]
    assert [each.runs for each in found.best] == [(2, 3), (0, 1)]
    assert (found.designs, found.feasible, found.open) == (4, 2, 1)


def test_what_would_have_to_change_is_said():
    table = _table(*RUNS)
    found = ranked(table, [USE], 5)
    names = {each.choices["motor"]: each.id for each in table.header.definition.configurations}
    assert list(what_would_change(found, table.header.definition)) == [
        f"2. {names['small']} (runs 0, 1) wins if its use falls by more than 0.5 (8.3 %)",
        f"{names['large']} (runs 4, 5), with use 3.5, wins if R1 were at most 0.8 instead of 0.5",
    ]
    assert claim(found) == (
        "of 4 designs 2 meet all requirements wherever they were run; 1 more were not run at all conditions and are not"
        " counted"
    )


def _rivals(*slips_and_uses):
    """What is said of designs that miss the bound of 0.5 on slip, beside one that meets it with a use of 6."""
    runs = [("small", 0.9, 0, 6.0, 0.2)] + [("large", 0.1 * k, 0, u, s) for k, (s, u) in enumerate(slips_and_uses)]
    table = _table(*runs)
    names = {each.choices["motor"]: each.id for each in table.header.definition.configurations}
    told = [*what_would_change(ranked(table, [USE], 5), table.header.definition)]
    return [text.replace(names["large"], "large") for text in told], table


def test_a_bound_that_lets_a_better_one_through_makes_no_winner():
    """Up to 0.8 run 2, with less use and slip than run 1, is let through, too."""
    told, _ = _rivals((0.8, 3.5), (0.7, 3.0))
    assert told == ["large (run 2), with use 3, wins if R1 were at most 0.7 instead of 0.5"]


def test_a_bound_is_told_rounded_outwards_and_what_else_that_lets_through_counts():
    told, _ = _rivals((0.71234, 3.5))
    assert told == ["large (run 1), with use 3.5, wins if R1 were at most 0.7124 instead of 0.5"]
    told, _ = _rivals((0.71234, 3.5), (0.71238, 3.0))
    assert told == ["large (run 2), with use 3, wins if R1 were at most 0.7124 instead of 0.5"]


def test_of_a_design_that_misses_both_bounds_nothing_is_said():
    table = _table(*RUNS[:2], ("large", 0.2, 0, 3.0, 0.7), ("large", 0.2, 1, 3.0, 0.9))
    assert len(ranked(table, [USE], 5).better) == 1
    definition = table.header.definition
    both = replace(definition, requirements=(replace(definition.requirements[0], at_least=0.8, at_most=0.85),))
    assert ranked(replace(table, header=replace(table.header, definition=both)), [USE], 5).better == ()


def test_what_every_sentence_says_is_so():
    """Of random designs: with the bound that is told, and nothing else changed, the design named is the best."""
    for seed in range(20):
        random = np.random.default_rng(seed)
        told, table = _rivals(*random.uniform([0.0, 1.0], [1.0, 6.0], (9, 2)).tolist())
        slip, use = table.metric("slip"), table.metric("use")
        for text in (text for text in told if "R1 were" in text):
            run, bound = (float(found) for found in re.findall(r"run (\d+)\).* at most (\S+)", text)[0])
            assert np.argmin(np.where(slip <= bound, use, np.inf)) == run, text


def test_what_is_to_be_large_wins_by_its_smallest_value():
    assert [each.values for each in ranked(_table(*RUNS), [Objective("use", maximize=True)], 5).best] == [
        (5.0,),
        (4.0,),
    ]


def test_metrics_and_sums_have_a_front_together():
    table = _table(*RUNS[:4], ("large", 0.2, 0, 3.0, 0.1), ("large", 0.2, 1, 3.5, 0.2))
    found = ranked(_priced(table, {"small": 10.0, "large": 30.0}), [COST, USE], 5)
    assert [each.values for each in found.best] == [(10.0, 5.5), (30.0, 3.5)]


def test_a_study_says_what_it_looks_for_unless_something_else_is_asked():
    table = _table(*RUNS)
    definition = replace(table.header.definition, objectives=(DefinedObjective("use"),))
    assert objectives_of(definition, (), ()) == [USE]
    assert objectives_of(definition, (), ("slip",)) == [Objective("slip", maximize=True)]
    with pytest.raises(DseError, match="neither a metric nor a sum 'sum\\(cost\\)'"):
        objectives_of(definition, ("sum(cost)",), ())


def test_without_objectives_designs_are_ranked_by_verdict_then_by_least_margin():
    """Slip is 0.4, 0.2 at worst in the two that meet it: margins of 20 % and 60 %; 0.8 is a miss by 60 %."""
    table = _table(*RUNS)
    found = ranked(table, [], 5)
    assert [(each.runs, each.slack, each.values) for each in found.best] == [
        ((0, 1), pytest.approx(0.6), ()),
        ((2, 3), pytest.approx(0.2), ()),
    ]
    assert [(each.runs, each.slack) for each in found.better] == [((4, 5), pytest.approx(-0.6))]
    names = {each.choices["motor"]: each.id for each in table.header.definition.configurations}
    assert list(what_would_change(found, table.header.definition)) == [
        f"{names['large']} (runs 4, 5) meets all requirements if R1 were at most 0.8 instead of 0.5"
    ]


def test_of_designs_that_miss_as_many_the_one_that_misses_least_comes_first():
    runs = [
        ("small", gain, slope, 1.0, slip) for gain, slip in ((0.2, 0.9), (0.4, 0.6), (0.6, 0.7)) for slope in (0, 1)
    ]
    found = ranked(_table(*runs), [], 5)
    assert (found.best, [each.point["gain"] for each in found.better]) == ((), [0.4, 0.6, 0.2])


def test_a_design_with_a_run_that_failed_is_no_design_to_take():
    table = _table(*RUNS, done=[True, True, False, True, True, True, True])
    assert [each.runs for each in ranked(table, [USE], 5).best] == [(0, 1)]


def test_a_part_of_the_ranges_lies_around_a_run_and_within_them():
    table = _table(*RUNS)
    narrowing = around(table, 2, 0.5)
    assert narrowing.ranges == {"gain": pytest.approx((0.15, 0.65))}
    assert narrowing.ids == (table.configurations[2],)
    assert around(table, 0, 1.0).ranges == {"gain": pytest.approx((0.0, 0.7))}
    with pytest.raises(DseError, match="there is no run 9"):
        around(table, 9, 0.5)
    whole = replace(around(table, 2, 2.0), ids=())
    assert whole.is_whole(table.header.definition)
    assert not replace(whole, ids=("c0",)).is_whole(table.header.definition)
    assert not narrowing.is_whole(table.header.definition)


def test_what_is_best_spans_the_next_ranges():
    table = _table(*RUNS)
    narrowing = around_designs(table, ranked(table, [USE], 5).best)
    assert narrowing.ranges == {"gain": pytest.approx((0.15, 0.45))}
    with pytest.raises(DseError, match="no design meets all requirements"):
        around_designs(table, ())


def test_a_box_narrows_ranges_and_choices_and_leaves_conditions():
    random = np.random.default_rng(4)
    count = 1500
    motors = np.where(random.random(count) < 0.5, "small", "large")
    gain, slope = random.random(count), random.integers(0, 2, count).astype(float)
    slip = np.where((gain > 0.6) & (motors == "small"), 0.1, 0.9)
    table = _table(*zip(motors.tolist(), gain, slope, slip, slip, strict=True))
    narrowing = of_box(table.header.definition, best_boxes(study_data(table))[0])
    assert narrowing.where == {"motor": ("small",)}
    assert narrowing.ranges["gain"] == (pytest.approx(0.6, abs=0.02), 1.0)


def test_an_objective_is_an_expression_in_metrics_and_sums_too():
    table = _table(*RUNS[:4], ("large", 0.2, 0, 3.0, 0.1), ("large", 0.2, 1, 3.5, 0.2))
    priced = _priced(table, {"small": 10.0, "large": 12.0})
    (found,) = objectives_of(priced.header.definition, ("sum(cost) + 2 EUR * use",), ())
    assert [each.values for each in ranked(priced, [found], 5).best] == [(19.0,), (21.0,), (22.0,)]
    assert unit_of_objective(priced.header.definition, found) == "EUR"
    with pytest.raises(DseError, match="cannot add currency and a plain number"):
        objectives_of(priced.header.definition, ("sum(cost) + use",), ())


def test_each_objective_is_told_with_the_conditions_where_it_is_worst():
    """Use is worst on the slope, 1; its largest value is best there where it is least, 0. A sum has no condition."""
    assert [each.at for each in ranked(_table(*RUNS), [USE], 5).best] == [({"slope": 1.0},)] * 2
    largest = ranked(_table(*RUNS), [Objective("use", maximize=True)], 5)
    assert [each.at for each in largest.best] == [({"slope": 0.0},)] * 2
    priced = ranked(_priced(_table(*RUNS), {"small": 10.0, "large": 30.0}), [COST, USE], 5)
    assert [each.at for each in priced.best] == [({}, {"slope": 1.0})]
    level = _table(("small", 0.2, 0, 5.0, 0.1), ("small", 0.2, 1, 5.0, 0.2), ("small", 0.3, 0, 6.0, 0.2))
    assert ranked(level, [USE], 5).best[0].at == ({},)
