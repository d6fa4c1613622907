"""Every figure there is, put through the suite that other packages run over theirs."""

from __future__ import annotations

import pytest

from dse.report.charts.chart import Axis, Chart, Line, Points
from dse.report.figure import FIGURES
from dse.testing.figures import FigureSuite

for _name in FIGURES.names():
    globals()[f"TestFigure_{_name}"] = type(f"TestFigure_{_name}", (FigureSuite,), {"figure": FIGURES.get(_name)})


def test_no_figure_was_left_out():
    assert {f"TestFigure_{name}" for name in FIGURES.names()} <= set(globals())
    assert {"constraints", "margins", "progress", "waveforms"} <= set(FIGURES.names())


class Careless:
    """Makes the mistakes one makes; each chart one of them."""

    title = "careless"

    def __init__(self, mistake):
        self.mistake = mistake
        self.calls = 0

    def charts(self, content):
        self.calls += 1
        metric, numbers = content.metrics[0].values, content.runs.numbers
        x = numbers.astype(float)
        axis = Axis("gap [m]" if self.mistake == "unit in the label" else "gap", "m")
        runs = numbers + 1 if self.mistake == "unknown run" else numbers
        if self.mistake == "memory":
            x = x + self.calls
        if self.mistake == "writes":
            metric.sort()
        values = metric if self.mistake == "infinite" else metric[:0] if self.mistake == "lengths" else x
        return [Chart("a", "A", Axis("run"), axis, (Line(x, values), Points(x, x, runs)))]


@pytest.mark.parametrize(
    ("mistake", "test"),
    [
        ("unit in the label", lambda suite: suite.test_axes_carry_their_unit("ordinary")),
        ("unknown run", lambda suite: suite.test_it_draws_every_study("ordinary")),
        ("lengths", lambda suite: suite.test_it_draws_every_study("ordinary")),
        ("infinite", lambda suite: suite.test_it_draws_every_study("infinite")),
        ("writes", lambda suite: suite.test_it_draws_every_study("ordinary")),
        ("memory", lambda suite: suite.test_the_same_study_gives_the_same_charts()),
        ("draws failed runs", lambda suite: suite.test_no_point_stands_for_a_run_that_failed("ordinary")),
    ],
)
def test_the_suite_finds_the_mistakes_one_makes(mistake, test):
    suite = FigureSuite()
    suite.figure = Careless(mistake)
    with pytest.raises((AssertionError, ValueError)):
        test(suite)
