"""Which design to take, in sentences: those of the report's page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from order_cases import ORDER_CASES, order_table

from dse.analysis import Interval, choice_of
from dse.analysis.decision import Effect
from dse.api import choice_lines
from dse.api.presentation.decision_text import verdicts
from dse.cli.choice import show_choice


@pytest.mark.parametrize("case", ORDER_CASES["cases"], ids=lambda case: f"{case['designs']}-{case['objectives']}")
def test_the_terminal_has_the_sentences_of_the_page(case: dict[str, Any], tmp_path: Path) -> None:
    table = order_table(tmp_path / "study", case)
    choice = choice_of(table)
    assert choice is not None
    name, lines = choice_lines(choice, table.header.definition)
    assert {"name": name, "lines": [list(line) for line in lines]} == case["choice"]


def test_one_verdict_is_no_plural() -> None:
    assert [verdicts(1), verdicts(2), verdicts(1000)] == ["1 verdict", "2 verdicts", "1,000 verdicts"]


def test_an_assumed_number_that_reverses_the_choice_is_named(tmp_path: Path) -> None:
    table = order_table(tmp_path / "study", ORDER_CASES["cases"][0])
    choice = choice_of(table, ["part_a.gain"])
    assert choice is not None
    levels = (Interval(-1.0, -2.0, -0.5), Interval(1.0, 0.5, 2.0))
    effect = Effect("world.speed", "R1", (10.0, 20.0), levels, Interval(2.0, 1.0, 3.0), is_assumed=True)
    reversed_ = replace(choice, decision=replace(choice.decision, effects=(effect,)))
    sure = dict(choice_lines(reversed_, table.header.definition)[1])["how sure"]
    assert "Which one has the larger margin of keeps its distance depends on the assumed speed." in sure
    assert sure.endswith("how the difference depends on them is not known.")


def test_briefly_the_result_and_what_is_cheaper_are_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = order_table(tmp_path / "study", ORDER_CASES["cases"][0])
    show_choice(choice_of(table), table.header.definition, briefly=True)
    printed = capsys.readouterr().out
    assert all(f"  {label}:" in printed for label in ("result", "cheaper"))
    assert not any(f"  {label}:" in printed for label in ("next", "how sure"))
    show_choice(None, table.header.definition)
    assert capsys.readouterr().out == ""
