"""What metrics may miss between rows."""

from __future__ import annotations

import numpy as np
import pytest

from dse.domain.bench import Metric, Requirement
from dse.domain.component import Kind, Type
from dse.errors import Location
from dse.expression.parse import parse_expression
from dse.metrics import between_rows, compile_metrics
from dse.units import parse_unit

HERE = Location("bench.yaml", 1, 1)
NUMBER = Type(Kind.REAL, parse_unit(""))


def off(text: str, x: list[float], step: float = 1.0) -> float:
    program = compile_metrics(
        [Metric("m", parse_expression(text, HERE), parse_unit(""))], [], {"x": NUMBER}, frozenset({"x"})
    )
    return between_rows(program, np.arange(len(x)) * step, {"x": np.array(x, dtype=np.float64)}, {})[0]["m"]


@pytest.mark.parametrize(
    ("text", "x", "expected"),
    [
        ("maximum(x)", [0, 3, 4, 3, 0], 0.0),
        ("maximum(x)", [1, 4, 4, 1], 0.375),  # 1 + 4.5 t - 1.5 t² has its vertex at 4.375
        ("minimum(x)", [-1, -4, -4, -1], 0.375),
        ("overshoot(x, target = 2)", [1, 4, 4, 1], 0.1875),
        ("maximum(x) - minimum(x)", [1, 4, 4, 1], 0.375),
        ("minimum(x)", [3, 2, 1, 0.5, 1.5, 2.5, 3.5], 0.25),  # 3 - t and t - 2.5 meet at 0.25
        ("maximum(x)", [4, 4, 1, -5], 0.375),  # the vertex may lie behind the first row
        ("maximum(x)", [1, 2, 3, 4], 0.0),
        ("maximum(x)", [5, 5, 5, 5], 0.0),
        ("maximum(x)", [7], 0.0),
        ("percentile(x, 100 %)", [1, 2, 4, 8], 4.0),  # of 3 s, a row stands for 1 s at most: a third lower is 4
        ("percentile(x, 50 %)", [5, 5, 5, 5], 0.0),
        ("minimum(1 / x)", [0, 1, 2, 0], 0.0),  # beside what is infinite
    ],
)
def test_a_peak_between_rows_is_where_a_parabola_or_two_lines_have_it(text, x, expected):
    assert off(text, x) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("duration(x > 2)", 1.0),
        ("2 * duration(x > 2) + final(x) * 1 s", 2.0),
        ("duration(x > 9)", 0.0),
        ("reach_time(x, target = 3, band = 0)", 0.5),
        ("reach_time(x + 5, target = 5)", 0.0),
        ("reach_time(x, target = 9)", 0.0),
        ("rise_time(x, target = 4)", 1.0),
        ("settling_time(x, target = 1, band = 0.5)", 0.5),
    ],
)
def test_each_crossing_lies_somewhere_in_a_step(text, expected):
    x = [0.0, 1.0, 4.0, 4.0, 1.0]
    unit = parse_unit("s")
    program = compile_metrics([Metric("m", parse_expression(text, HERE), unit)], [], {"x": NUMBER}, frozenset({"x"}))
    found, _ = between_rows(program, np.arange(5) * 0.5, {"x": np.array(x)}, {})
    assert found["m"] == pytest.approx(expected)


def test_what_a_condition_picks_may_be_any_value_of_its_step():
    assert off("at_first(x, x > 2)", [0.0, 1.0, 4.0, 5.0]) == 3.0


def test_a_verdict_that_depends_on_what_is_between_rows_is_seen():
    metrics = [
        Metric("peak", parse_expression("maximum(x)", HERE), parse_unit("")),
        Metric("end", parse_expression("final(x)", HERE), parse_unit("")),
    ]
    requirement = Requirement(
        "R", "end", at_most=2.0, unit=parse_unit(""), exercised_when=parse_expression("peak > 4.2", HERE)
    )
    program = compile_metrics(metrics, [requirement], {"x": NUMBER}, frozenset({"x"}))
    _, judged = between_rows(program, np.arange(4.0), {"x": np.array([1.0, 4.0, 4.0, 1.0])}, {})
    assert {str(each.verdict) for each in judged} == {"pass", "not exercised"}
