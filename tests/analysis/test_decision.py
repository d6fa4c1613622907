"""Which of two designs is ahead, and what would have to change."""

from __future__ import annotations

import math
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pair_cases import PAIR_CASES, pair_table

from dse.analysis import decide_between
from dse.analysis.decision import (
    bound_changes,
    effect_of,
    is_price,
    objective_changes,
    student,
)
from dse.analysis.order import ahead_by
from dse.storage import RunTable, over_draws

NAN = math.nan


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> RunTable:
    return pair_table(tmp_path_factory.mktemp("pair") / "study")


def number_of(table: RunTable, design: list[Any]) -> str:
    name, gain = design
    rows = zip(table.numbers.tolist(), table.configurations, table.points["part.gain"], strict=True)
    return next(str(number) for number, configuration, at in rows if (configuration, at) == (name, gain))


def near(found: Any, wanted: Any) -> bool:
    return np.allclose(np.array(found, dtype=np.float64), np.array(wanted, dtype=np.float64), atol=1e-9, equal_nan=True)


def interval(given: Any) -> list[float]:
    return [given.value, given.low, given.high]


def test_the_points_of_the_page_are_those_of_the_draws_that_decide(table: RunTable) -> None:
    points = over_draws(table)
    found = zip(
        points.configurations,
        points.points["part.gain"],
        points.points["world.speed"],
        points.metric("gap"),
        strict=True,
    )
    assert [[name, *values] for name, *values in found] == PAIR_CASES["points"]


@pytest.mark.parametrize("wanted", PAIR_CASES["decisions"], ids=lambda each: f"{each['first']}-{each['second']}")
def test_two_designs_are_decided_between_as_on_the_page(table: RunTable, wanted: dict[str, Any]) -> None:
    found = decide_between(table, number_of(table, wanted["first"]), number_of(table, wanted["second"]))
    assert [found.first.missed, found.second.missed] == wanted["missed"]
    assert [found.first.judged, found.second.judged] == wanted["judged"]
    assert found.ahead == wanted["ahead"]
    assert near([found.first.objectives, found.second.objectives], wanted["objectives"])
    for pair, expected in zip(found.pairs, wanted["pairs"], strict=True):
        counts = [getattr(pair, name) for name in ("both", "first", "second", "neither")]
        assert counts == [expected[name] for name in ("both", "first", "second", "neither")]
        assert near([pair.case[0], pair.margin, pair.error], [expected["speed"], expected["margin"], expected["error"]])
        assert near([pair.difference, pair.low, pair.high], expected["difference"])
    assert found.are_random == (wanted["leading"] is not None)
    if wanted["leading"]:
        assert near(interval(found.leading["R"]), wanted["leading"])
    assert near([(each.shift, each.ahead) for each in found.bounds], wanted["bounds"])
    assert near([(0, each.change, each.ahead) for each in found.changes], wanted["changes"])
    assert [(each.variable, list(each.values)) for each in found.effects] == [
        (each["variable"], each["values"]) for each in wanted["effects"]
    ]
    for effect, expected in zip(found.effects, wanted["effects"], strict=True):
        assert near([interval(level) for level in effect.levels], expected["levels"])
        assert near(interval(effect.change), expected["change"])


def keys_of(missed: Any, open_: Any, tie: int) -> Any:
    """Keys of both designs: missed verdicts for certain, open ones, and what decides a tie."""
    ties = {1: (0.0, 1.0), 0: (0.0, 0.0), -1: (1.0, 0.0)}[tie]
    return tuple((0.0, float(m - o), float(o), last) for m, o, last in zip(missed, open_, ties, strict=True))


def sides_of(case: dict[str, Any]) -> Iterator[list[tuple[float, bool]]]:
    for name, left in zip(("first", "second"), case["doubtful"], strict=True):
        missed = [n for n, each in enumerate(case[name]) if each is not None and each < 0][:left]
        yield [(NAN if each is None else each, n in missed) for n, each in enumerate(case[name])]


@pytest.mark.parametrize("case", PAIR_CASES["bounds"])
def test_bounds_that_change_the_order_are_found(case: dict[str, Any]) -> None:
    keys = keys_of(case["missed"], case["doubtful"], case["tie"])
    assert [list(each) for each in bound_changes(*sides_of(case), keys, 0)] == case["changes"]


@given(
    st.lists(st.tuples(st.integers(-4, 4), st.booleans()), min_size=1, max_size=5),
    st.lists(st.tuples(st.integers(-4, 4), st.booleans()), min_size=1, max_size=5),
    st.integers(-1, 1),
)
def test_no_smaller_move_of_the_bound_changes_the_order(
    first: list[tuple[int, bool]], second: list[tuple[int, bool]], tie: int
) -> None:
    def ahead(shift: float) -> int:
        missed = [sum(margin < shift for margin, _ in own) for own in (first, second)]
        unsure = [sum(margin < min(shift, 0) and is_open for margin, is_open in own) for own in (first, second)]
        return ahead_by(*keys_of(missed, unsure, tie))[0]

    keys = keys_of(
        [sum(margin < 0 for margin, _ in own) for own in (first, second)],
        [sum(margin < 0 and is_open for margin, is_open in own) for own in (first, second)],
        tie,
    )
    sides: Any = [[(margin, is_open and margin < 0) for margin, is_open in own] for own in (first, second)]
    for shift, then in bound_changes(*sides, keys, 0):
        beyond = shift if shift < 0 else shift + 0.5
        assert ahead(beyond) == then != ahead(0)
        for step in np.arange(0, beyond, math.copysign(0.5, beyond)):
            assert ahead(float(step)) == ahead(0)


@pytest.mark.parametrize("case", PAIR_CASES["objectives"])
def test_the_objective_that_changes_the_order_is_found(case: dict[str, Any]) -> None:
    values = [tuple(math.inf if each is None else each for each in pair) for pair in case["values"]]
    first, second = zip(*values, strict=True)
    assert ahead_by(first, second)[0] == case["ahead"]
    assert [list(each) for each in objective_changes(values)] == case["changes"]
    for n, change, then in objective_changes(values):
        beyond = change * (1 + 1e-9)
        moved = [a + beyond * (k == n) for k, a in enumerate(first)]
        assert ahead_by(tuple(moved), second)[0] == then


def test_a_straight_line_through_many_values_is_that_of_least_squares() -> None:
    stats = pytest.importorskip("scipy.stats")
    points = PAIR_CASES["line"]["points"]
    pairs: Any = [(x, SimpleNamespace(margin=y, error=0.0)) for x, y in points]
    found = effect_of(pairs)
    assert found is not None
    values, levels, change, is_line = found
    assert is_line
    line = stats.linregress(*np.transpose(points))
    reach = values[1] - values[0]
    assert change.value == pytest.approx(line.slope * reach)
    # Student's t is to 0.2 %.
    assert change.high - change.value == pytest.approx(stats.t.ppf(0.975, 12) * line.stderr * reach, rel=2e-3)
    assert levels[0].value == pytest.approx(line.intercept + line.slope * values[0])
    assert near(
        [interval(each) for each in (*levels, change)], [*PAIR_CASES["line"]["levels"], PAIR_CASES["line"]["change"]]
    )
    for freedom in (10, 12, 30, 500):
        assert student(freedom) == pytest.approx(stats.t.ppf(0.975, freedom), rel=2e-3)


def test_runs_without_noise_that_do_not_depend_on_a_number_have_no_effect_of_it() -> None:
    margins = (0.1 + 0.2, 0.3, 0.3)  # equal but for rounding
    found = effect_of([(float(n), SimpleNamespace(margin=each, error=0.0)) for n, each in enumerate(margins)])  # type: ignore[misc]  # only these two are read
    assert found is not None
    assert interval(found[2]) == [0.0, 0.0, 0.0]


def test_numbers_of_the_parts_of_either_design_are_assumed_by_their_names_in_the_study(table: RunTable) -> None:
    names = number_of(table, ["a", 0.0]), number_of(table, ["b", 0.0])
    found = decide_between(table, *names, ["part_a.gain", "part_b.noise", "part_q.level"])
    assert found.assumed == ("part.gain", "part.noise")
    assert [each.is_assumed for each in found.effects] == [False, True]
    assert decide_between(table, *names).assumed is None


def test_only_a_currency_is_a_price() -> None:
    assert [is_price(unit) for unit in ("EUR", "kg", "", "<b>")] == [True, False, False, False]
