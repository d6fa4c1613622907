"""What every figure must do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, is_dataclass

import numpy as np
import pytest

from dse.report import (
    ConfigurationEntry,
    Figure,
    MetricColumn,
    Points,
    PrintedFigure,
    Property,
    ReportContent,
    ReportVariable,
    RequirementRow,
    Runs,
    SamplerKind,
    View,
    chart_problems,
)

STUDIES = ("ordinary", "empty", "of one run", "all failed", "undefined", "infinite", "of three configurations", "bare")


def study(kind: str) -> ReportContent:
    """A small made-up study of one of the *STUDIES*: two variables, three metrics and requirements of every form."""
    n = {"empty": 0, "of one run": 1}.get(kind, 40)
    numbers = np.arange(100, 100 + n, dtype=np.int64)
    x, y = np.random.default_rng(7).random((2, n))
    done = np.full(n, kind != "all failed")
    if n > 1:
        done[3] = False
    outcome = np.where(done, {"undefined": np.nan, "infinite": np.inf}.get(kind, 0.0), np.nan)
    configurations = ("a", "b", "c") if kind == "of three configurations" else ("a",)
    metrics = (
        MetricColumn("gap", "smallest gap", "m", 40 * x - 5 * y + outcome),
        MetricColumn("peak", "", "", y - x + outcome, np.full(n, 0.01)),
        MetricColumn("alike", "always alike", "km/h", np.full(n, 3.0) + outcome),
    )
    requirements = (
        RequirementRow("R1", "far enough", "gap", None, 4.0, x < 0.9),
        RequirementRow("R2", "", "peak", 0.5, -0.5, np.ones(n, dtype=bool)),
        RequirementRow("R3", "never exercised", "alike", 3.0, None, np.zeros(n, dtype=bool)),
    )
    bare = kind == "bare"
    return ReportContent(
        f"a study that is {kind}",
        SamplerKind.SCATTERED,
        "out/study",
        Runs(
            numbers,
            tuple(configurations[i % len(configurations)] for i in range(n)),
            done,
            tuple("" if ok else "it broke" for ok in done),
        ),
        tuple(ConfigurationEntry(name, {"brake": name}, {"mass": Property(3.0, "kg")}) for name in configurations),
        ()
        if bare
        else (
            ReportVariable("v.x", "gain", "1/s", 0, 1, None, 0.5, x),
            ReportVariable("v.y", "", "", 0, 1, None, 0.5, y),
        ),
        () if bare else metrics,
        () if bare else requirements,
    )


class FigureSuite:
    """Subclass it in your tests and give your *figure*: ``class TestMine(FigureSuite): figure = FIGURE``."""

    figure: Figure

    def test_it_has_a_title(self) -> None:
        assert isinstance(self.figure.title, str)
        assert self.figure.title.strip(), "the title is empty"

    @pytest.mark.parametrize("kind", STUDIES)
    def test_it_draws_every_study(self, kind: str) -> None:
        """No study makes it raise, and all it gives can be drawn: finite or NaN, equal lengths, runs that exist."""
        content = study(kind)
        problems = [
            problem
            for chart in self.figure.charts(content)
            for problem in chart_problems(chart, content.runs.numbers.tolist())
        ]
        assert not problems, "; ".join(problems)

    @pytest.mark.parametrize("kind", STUDIES)
    def test_its_charts_can_be_told_apart(self, kind: str) -> None:
        """Each has a name and a title of its own figure."""
        charts = self.figure.charts(study(kind))
        names = [chart.name for chart in charts]
        assert len(set(names)) == len(names), f"two charts have one name: {names}"
        assert all(chart.title.strip() for chart in charts), "a chart has no title"

    def test_the_same_study_gives_the_same_charts(self) -> None:
        """No clock, no chance, no memory of what was drawn before."""
        content = study("ordinary")
        first = _plain(self.figure.charts(content))
        self.figure.charts(study("of three configurations"))
        assert _plain(self.figure.charts(content)) == first, "the same study gave other charts"

    @pytest.mark.parametrize("kind", STUDIES)
    def test_axes_carry_their_unit(self, kind: str) -> None:
        """In its own place, where the page and print show it as ``gap [m]``, and never in the label."""
        for chart in self.figure.charts(study(kind)):
            for axis in (chart.x, chart.y):
                assert axis.label.strip(), f"an axis of '{chart.name}' has no label"
                assert "[" not in axis.label, f"'{axis.label}': the unit goes into Axis.unit"

    @pytest.mark.parametrize("kind", STUDIES)
    def test_no_point_stands_for_a_run_that_failed(self, kind: str) -> None:
        content = study(kind)
        failed = set(content.runs.numbers[~content.runs.done].tolist())
        for chart in self.figure.charts(content):
            for points in (drawn for drawn in chart.drawn if isinstance(drawn, Points)):
                drawn_runs = points.runs[~np.isnan(points.x) & ~np.isnan(points.y)]
                assert not failed & set(drawn_runs.tolist()), f"'{chart.name}' draws a failed run"

    def test_it_can_be_printed(self) -> None:
        """By the drawing of its charts, or by its own."""
        from dse.report import draw_chart

        content = study("ordinary")
        for chart in self.figure.charts(content):
            draw_chart(chart)
        if isinstance(self.figure, PrintedFigure):
            names = [name for name, _ in self.figure.drawings(content, View())]
            assert len(set(names)) == len(names), f"two drawings have one name: {names}"


def _plain(value: object) -> object:
    """*value* with every array as text, so that two can be compared."""
    if isinstance(value, np.ndarray):
        return value.tolist().__repr__()
    if is_dataclass(value):
        return type(value).__name__, *(_plain(getattr(value, field.name)) for field in fields(value))
    if isinstance(value, Sequence) and not isinstance(value, str):
        return tuple(map(_plain, value))
    return value
