"""The order of designs: which of them to take."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from definitions import at_most_one, stored_definition
from order_cases import ORDER_CASES, order_table

from dse.analysis import choice_of, objectives_of, ranked, severities_of, severity_levels
from dse.analysis.design_ranking import ordered
from dse.storage import over_draws

CASES = ORDER_CASES["cases"]


def named(case: dict[str, Any]) -> str:
    return f"{case['designs']}-{case['objectives']}"


@pytest.mark.parametrize("case", CASES, ids=named)
def test_designs_are_in_the_order_of_the_page(case: dict[str, Any], tmp_path: Path) -> None:
    table = over_draws(order_table(tmp_path / "study", case))
    _, designs, _, order = ordered(table, objectives_of(table.header.definition, (), ()))
    assert "".join(designs.configurations[row] for row in order.first_to_last) == case["order"]
    for name, key in zip(designs.configurations, order.keys, strict=True):
        assert np.allclose(key, case["keys"][name], atol=1e-9)


@pytest.mark.parametrize("case", CASES, ids=named)
def test_the_design_to_take_and_the_best_ones_are_the_first_in_the_order(case: dict[str, Any], tmp_path: Path) -> None:
    table = order_table(tmp_path / "study", case)
    found = choice_of(table)
    assert found is not None
    assert [found.decision.first.configuration, found.decision.second.configuration] == list(case["order"][:2])
    wanted = objectives_of(table.header.definition, (), ())
    if len(wanted) < 2:
        best = ranked(over_draws(table), wanted, 9).best
        assert [each.configuration for each in best] == list(case["order"][: found.feasible])


def test_points_of_the_page_are_those_of_the_draws_that_decide(tmp_path: Path) -> None:
    table = over_draws(order_table(tmp_path / "study", CASES[0]))
    assert table.rates is not None
    ends = [table.rates.interval(column) for column in range(3)]
    for row, (name, speed, number, gap, peak, rates) in enumerate(ORDER_CASES["points"]):
        assert (table.configurations[row], table.points["world.speed"][row], table.numbers[row]) == (
            name,
            speed,
            number,
        )
        assert np.array_equal(
            [table.metric("gap")[row], table.metric("peak")[row]],
            [gap, np.nan if peak is None else peak],
            equal_nan=True,
        )
        for column, wanted in enumerate(rates):
            found = [table.rates.met[row, column], table.rates.judged[row, column], *(end[row] for end in ends[column])]
            assert np.allclose(found, wanted, atol=1e-6)


def test_severities_are_in_their_usual_order_and_requirements_without_one_are_last() -> None:
    words = ("low", "", "our own", "Critical", "another", "major ", "critical")
    requirements = tuple(
        replace(each, severity=word)
        for each, word in zip(at_most_one("x", *map(str, range(len(words)))), words, strict=True)
    )
    definition = stored_definition(requirements=requirements)
    assert severities_of(definition) == ("critical", "major", "low", "our own", "another", "")
    assert severity_levels(definition) == (2, 5, 3, 0, 4, 1, 0)


def test_a_study_with_one_design_or_without_requirements_has_no_choice(tmp_path: Path) -> None:
    one = order_table(tmp_path / "one", {"designs": "a", "objectives": []})
    assert choice_of(one) is None
    two = order_table(tmp_path / "two", {"designs": "ab", "objectives": []})
    assert choice_of(two) is not None
    without = order_table(tmp_path / "none", {"designs": "ab", "objectives": [], "requirements": []})
    assert choice_of(without) is None


def test_no_design_is_named_if_none_was_run_at_all_conditions(tmp_path: Path) -> None:
    runs = [["a", 20.0, 0, 2.6, 0.6], ["f", 10.0, 0, 3.0, 0.25]]
    assert choice_of(order_table(tmp_path / "study", {"designs": "af", "objectives": [], "runs": runs})) is None
