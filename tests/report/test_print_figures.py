"""Figures that only print has: the page shows the same in views of its own."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from dse.report import View, drawings, save_drawing
from dse.report.content.data import ObjectiveEntry, Property, ReportContent
from dse.report.content.insight import (
    Asked,
    Bar,
    ChanceMap,
    FactorAxis,
    Insight,
    Part,
    Response,
    SearchCourse,
    Stage,
)
from dse.report.verdicts import Mark, overall_marks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAMES = ("alternatives", "boundary", "conditions", "effects", "front", "parallel", "search")
NOTHING = Asked((), (), (), (), ())


def drawn(name: str, content: ReportContent) -> dict[str, Figure]:
    return dict(drawings(name, content, View()))


def with_insight(content: ReportContent, **told: object) -> ReportContent:
    return dataclasses.replace(content, insight=Insight(NOTHING, **told))  # type: ignore[arg-type]


def with_two_configurations(content: ReportContent) -> ReportContent:
    """Every second run is of a configuration with another sensor, which costs more."""
    first = content.configurations[0]
    entries = tuple(
        dataclasses.replace(first, id=name, choices={"sensor": name}, properties={"cost": Property(cost, "EUR")})
        for name, cost in (("radar", 10.0), ("lidar", 30.0))
    )
    names = tuple(("radar", "lidar")[row % 2] for row in range(len(content.runs)))
    runs = dataclasses.replace(content.runs, configurations=names)
    return dataclasses.replace(content, configurations=entries, runs=runs)


def test_bars_of_effects_are_as_long_as_the_shares(sliced: ReportContent) -> None:
    factors = (FactorAxis("kp", "1/s", 0, (0.0, 1.0)), FactorAxis("sensor", "", -1, (), ("a", "b")))
    response = Response(0, (Bar(0, (0.6, 0.5, 0.7)), Bar(1, (0.1, np.nan, np.nan))), (), None, ())
    part = Part((0, 1), factors, 100, 0, (), (response,))
    (figure,) = drawn("effects", with_insight(sliced, parts=(part,))).values()
    (axes,) = figure.axes
    assert [bar.get_width() for bar in axes.patches] == pytest.approx([10.0, 60.0])
    assert [label.get_text() for label in axes.get_yticklabels()] == ["sensor", "kp"]


def test_a_cell_of_the_conditions_tells_the_share_of_the_judged_runs_that_pass(sliced: ReportContent) -> None:
    slow = np.arange(len(sliced.runs)) % 3 == 0
    first = dataclasses.replace(
        sliced.variables[0], role="condition", values=np.where(slow, 0.0, 1.0), labels=("slow", "fast")
    )
    content = dataclasses.replace(sliced, variables=(first, *sliced.variables[1:]))
    figure = drawn("conditions", content)["conditions"]
    marks = overall_marks(content)
    expected = []
    for rows in (slow, ~slow):
        passing = np.count_nonzero(marks[rows] == Mark.PASS)
        judged = passing + np.count_nonzero(marks[rows] == Mark.FAIL)
        expected.append(f"{100 * passing / judged:.0f} %\n{judged:,}")
    (axes,) = figure.axes
    assert [text.get_text() for text in axes.texts] == expected
    assert [label.get_text() for label in axes.get_xticklabels()] == ["slow", "fast"]


def test_boxes_of_alternatives_have_the_medians_of_their_runs(sliced: ReportContent) -> None:
    content = with_two_configurations(sliced)
    metric = content.metrics[0]
    (axes,) = drawn("alternatives", content)[f"alternatives_{metric.name}"].axes
    medians = {float(line.get_xdata()[0]) for line in axes.lines if line.get_linewidth() == 1.6}
    names = np.array(content.runs.configurations)
    finite = np.isfinite(metric.values)
    assert medians == {float(np.median(metric.values[finite & (names == name)])) for name in ("radar", "lidar")}


def test_the_front_holds_the_passing_runs_that_no_other_is_better_than(sliced: ReportContent) -> None:
    content = dataclasses.replace(
        with_two_configurations(sliced),
        objectives=(ObjectiveEntry(sliced.metrics[1].name), ObjectiveEntry("cost", is_property=True)),
    )
    (axes,) = drawn("front", content)["front_1"].axes
    front = next(line for line in axes.lines if line.get_label() == "front of the designs that pass")
    passing = overall_marks(content) == Mark.PASS
    names, values = np.array(content.runs.configurations), content.metrics[1].values
    cheap = values[passing & (names == "radar") & np.isfinite(values)].min()
    dear = values[passing & (names == "lidar") & np.isfinite(values)].min()
    expected = [(cheap, 10.0)] if cheap <= dear else [(dear, 30.0), (cheap, 10.0)]
    assert sorted({(float(x), float(y)) for x, y in zip(*front.get_data(), strict=True)}) == sorted(expected)


def test_of_a_single_objective_the_requirements_metrics_are_the_other_axis(sliced: ReportContent) -> None:
    content = dataclasses.replace(sliced, objectives=(ObjectiveEntry(sliced.metrics[2].name, maximize=True),))
    assert list(drawn("front", content)) == ["front_1", "front_2"]


def test_every_run_is_a_line_in_parallel_coordinates_with_ends_at_its_extremes(sliced: ReportContent) -> None:
    (axes,) = drawn("parallel", sliced)["parallel"].axes
    lines = [line for line in axes.lines if len(line.get_ydata()) > 2]
    assert len(lines) == len(sliced.runs)
    heights = np.array([line.get_ydata() for line in lines])
    assert np.nanmin(heights, axis=0).tolist() == [0.0] * heights.shape[1]
    assert np.nanmax(heights, axis=0).tolist() == [1.0] * heights.shape[1]


def test_the_band_is_hatched_where_a_verdict_is_in_doubt(sliced: ReportContent) -> None:
    passing = np.tile(np.linspace(0, 100, 8), 8).astype(np.uint8)
    doubt = np.minimum(passing, 100 - passing).astype(np.uint8)
    chance = ChanceMap((0, 1), 0, 0, 8, passing, doubt, 0.07, ((2, 0.12),), 90, 100)
    (figure,) = drawn("boundary", with_insight(sliced, chances=(chance,))).values()
    texts = " ".join(str(text.get_text()) for text in figure.texts) + str(figure.get_supxlabel())
    assert "90 of 100 runs" in texts
    assert "7.0 %" in texts
    hatched = [each for each in figure.axes[0].collections if getattr(each, "hatches", None) == ["////"]]
    assert len(hatched) == 1
    certain = dataclasses.replace(chance, misjudged=np.zeros(64, dtype=np.uint8))
    (plain,) = drawn("boundary", with_insight(sliced, chances=(certain,))).values()
    assert not [each for each in plain.axes[0].collections if getattr(each, "hatches", None) == ["////"]]


def test_the_search_climbs_by_its_stages(sliced: ReportContent) -> None:
    stages = tuple(Stage(runs, 1, volume, np.nan) for runs, volume in ((10, 0.0), (20, 0.5), (30, 1.0)))
    search = SearchCourse(("minimize a", "minimize b"), ("", ""), (), -1, 30, 4, 0, stages)
    (axes,) = drawn("search", with_insight(sliced, search=search))["search"].axes
    (line,) = axes.lines
    assert line.get_xdata().tolist() == [10, 20, 30]
    assert line.get_ydata().tolist() == [0.0, 0.5, 1.0]


@pytest.mark.parametrize("name", NAMES)
def test_a_study_that_a_figure_has_nothing_of_gives_no_drawing(name: str, bench_only: ReportContent) -> None:
    one = dataclasses.replace(bench_only, configurations=bench_only.configurations[:1])
    runs = dataclasses.replace(one.runs, configurations=(one.configurations[0].id,) * len(one.runs))
    assert drawn(name, dataclasses.replace(one, runs=runs)) == {}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", ["alternatives", "parallel"])
def test_the_same_content_gives_the_same_bytes(name: str, sliced: ReportContent, tmp_path: Path) -> None:
    content = with_two_configurations(sliced)
    for turn in ("a", "b"):
        (tmp_path / turn).mkdir()
        for stem, figure in drawn(name, content).items():
            save_drawing(figure, tmp_path / turn / f"{stem}.svg")
    first, second = (sorted((tmp_path / turn).iterdir()) for turn in ("a", "b"))
    assert [file.read_bytes() for file in first] == [file.read_bytes() for file in second]
    assert first
