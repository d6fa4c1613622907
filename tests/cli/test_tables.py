"""Numbers and their error bars on the terminal."""

from __future__ import annotations

import math

import pytest
from definitions import stored_definition
from rich.console import Console

import dse
from dse.api.presentation.quantities import checked_quantity
from dse.cli.runs import metric_table
from dse.domain.definition import DefinedMetric
from dse.domain.run import Outcome, Run, RunRequest


@pytest.mark.parametrize(
    ("value", "bar", "unit", "shown"),
    [
        (40.00512, 2.2e-4, "m", "40.00512 ± 0.00022 m"),
        (-0.0002, 5.4e-6, "%", "-0.02000 ± 0.00054 %"),
        (6.112 * 3.6e6, 3.6e4, "kWh", "6.112 ± 0.010 kWh"),
        (293.15, 0.1, "degC", "20.00 ± 0.10 degC"),
        (0.1, 2.8e-16, "m", "0.1 ± 2.8e-16 m"),
        (12345678.0, 1234.0, "m", "12345678 ± 1.2e+03 m"),
        (0.0, 0.01, "m", "0.000 ± 0.010 m"),
        (3.0, 0.0, "", "3 ± 0"),
        (3.0, math.inf, "m", "3 ± ∞ m"),
        (3.0, math.nan, "m", "3 ± ? m"),
        (math.nan, math.nan, "m", "–"),
        (math.inf, 0.0, "s", "inf s"),
        (5.0, None, "m", "5 m"),
    ],
)
def test_a_value_is_shown_to_the_last_digit_of_its_error_bar(value, bar, unit, shown):
    assert checked_quantity(value, bar, unit) == shown


def test_without_requirements_there_is_nothing_but_metric_and_value():
    definition = stored_definition(metrics=(DefinedMetric("end", "End", "m", "final(x)"),))
    run = Run(RunRequest(0, "abc", {}), Outcome.DONE, {"end": 2.0}, ())
    screen = Console(width=80)
    with screen.capture() as shown:
        screen.print(metric_table(dse.Run(run, definition)))
    assert [line.split() for line in shown.get().splitlines()] == [["metric", "value"], ["End", "2", "m"]]
