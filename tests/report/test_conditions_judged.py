"""Designs at the worst of their conditions, in print and on the page: three studies whose counts are worked by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from chromium import rest
from known_functions import study, variable
from report_pages import Open, counts, open_tab, settle

from dse.analysis import planes
from dse.report.charts.chart import Points
from dse.report.content.data import (
    ConfigurationEntry,
    MetricColumn,
    ReportContent,
    ReportVariable,
    RequirementRow,
    Runs,
    SamplerKind,
)
from dse.report.content.reading import _variable
from dse.report.drawing.constraint_plot import draw_constraint_plot
from dse.report.figures.constraints import axis_pairs, constraint_plot_data
from dse.report.figures.margins import Margins
from dse.report.insight.naming import Naming
from dse.report.insight.probability_maps import chances_of
from dse.report.verdicts import Mark, alike, conditions_of, marks_of_designs, worst_marks


def _content(variables, y, at_most, sampler=SamplerKind.FULL_FACTORIAL, brakes=None, exercised=None):
    n = len(y)
    entries = sorted(set(brakes or ["c"]))
    return ReportContent(
        "Judged",
        sampler,
        "out/judged",
        Runs(np.arange(n), tuple(brakes or ["c"] * n), np.ones(n, dtype=bool), ("",) * n),
        tuple(ConfigurationEntry(name, {"brake": name} if brakes else {}, {}) for name in entries),
        variables,
        (MetricColumn("y", "y", "m", y), MetricColumn("z", "z", "", y)),
        (RequirementRow("R", "close", "y", at_most, None, np.ones(n, dtype=bool) if exercised is None else exercised),),
    )


def _crossed(*axes):
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes)).T


def pairs() -> ReportContent:
    """0.2 + load / 2 - gain is to be at most 0, for gains of k / 11, nine rates, empty (0) and loaded (1).

    Empty pass the nine gains from 3 / 11 on, 81 of 108 pairs; loaded, and so at worst, the four from 8 / 11 on: 36.
    """
    gain, rate, load = _crossed(np.linspace(0, 1, 12), np.linspace(0, 1, 9), [0.0, 1.0])
    variables = (
        ReportVariable("gain", "gain", "", 0, 1, 12, 0.5, gain),
        ReportVariable("rate", "rate", "", 0, 1, 9, 0.5, rate),
        ReportVariable("load", "load", "kg", 0, 1, None, 0, load, role="condition"),
    )
    return _content(variables, 0.2 + load / 2 - gain, 0.0)


def weather() -> ReportContent:
    """y is 1 - gain in fog and gain in rain, with a drum 0.2 more on a slope; it is to be at most 0.7501.

    Of 41 gains a disc takes 0.25 … 0.75, which are 21, a drum 0.45 … 0.55, which are 5: 26 of 82 designs.
    """
    drum, gain, sky, slope = _crossed([0.0, 1.0], np.linspace(0, 1, 41), [0.0, 1.0], [0.0, 1.0])
    variables = (
        ReportVariable("sky", "sky", "", 0, 1, None, 0, sky, labels=("fog", "rain"), role="condition"),
        ReportVariable("slope", "slope", "%", 0, 1, None, 0, slope, role="condition"),
        ReportVariable("gain", "gain", "", 0, 1, 41, 0.5, gain),
    )
    y = np.where(sky == 1, gain, 1 - gain) + 0.2 * drum * slope
    return _content(variables, y, 0.7501, brakes=["drum" if each else "disc" for each in drum])


def scattered() -> ReportContent:
    """x1 + load is to be at most 0.65 under loads of 0, 0.2 and 0.4, of x1 = 0.005, 0.015 … 0.995 in any order.

    Under 0 the first 65 pass, under 0.2 the first 45, under 0.4, and so at worst, the first 25.
    """
    order = np.random.default_rng(3).permutation(100)
    rows = [(order[i] / 100 + 0.005, order[(7 * i) % 100] / 100, load) for i in range(100) for load in (0.0, 0.2, 0.4)]
    x1, x2, load = np.array(rows).T
    variables = (
        ReportVariable("x1", "x1", "", 0, 1, None, 0.5, x1),
        ReportVariable("x2", "x2", "", 0, 1, None, 0.5, x2),
        ReportVariable("load", "load", "kg", 0, 0.4, None, 0.2, load, role="condition"),
    )
    return _content(variables, x1 + load, 0.65, SamplerKind.SCATTERED)


@pytest.mark.parametrize(("made", "passing", "designs"), [(pairs, 36, 108), (weather, 26, 82), (scattered, 25, 100)])
def test_a_design_is_marked_by_its_worst_condition(made, passing, designs):
    content = made()
    conditions = conditions_of(content)
    rows = alike(content, [each.name for each in content.variables if each not in conditions])
    marks = worst_marks(content, rows, conditions)
    assert (int((marks == Mark.PASS).sum()), len(marks)) == (passing, designs)
    runs = marks_of_designs(content) == Mark.PASS
    assert int(runs.sum()) == passing * len(runs) // designs


def test_a_design_that_lacks_a_condition_does_not_pass():
    content = pairs()
    rows = alike(content, ["gain", "rate"])
    marks = worst_marks(content, [rows[-1], rows[-1][:1]], conditions_of(content))
    assert marks.tolist() == [Mark.PASS, Mark.NOT_EXERCISED]


def test_the_printed_constraint_plot_is_that_of_the_worst_condition():
    content = pairs()
    ((x, y),) = axis_pairs(content)
    assert (x, y) == ("gain", "rate")
    data = constraint_plot_data(content, x, y, "c")
    assert int((data.marks == Mark.PASS).sum()) == 36
    assert data.points.shape == (108, 2)
    assert int(data.feasible.sum()) == 36
    (layer,) = data.layers
    assert layer.margin[0] == pytest.approx(np.linspace(0, 1, 12) - 0.7)
    assert data.title.endswith(": worst of 2 conditions")


def test_a_condition_that_does_not_exercise_a_requirement_is_not_its_worst():
    """Loaded runs do not exercise it: the nine gains that pass empty are left."""
    load = pairs().variables[2].values
    content = _content(pairs().variables, pairs().metrics[0].values, 0.0, exercised=load == 0)
    data = constraint_plot_data(content, "gain", "rate", "c")
    assert int((data.marks == Mark.PASS).sum()) == int(data.feasible.sum()) == 81


def test_margins_are_those_of_designs_at_their_worst_condition():
    """Nine pairs each at the twelve gains, loaded; the runs are the loaded ones."""
    (chart,) = Margins().charts(pairs())
    points = [part for part in chart.drawn if isinstance(part, Points)]
    assert {part.label: len(part.x) for part in points} == {"fail": 72, "pass": 36}
    assert all((part.runs % 2 == 1).all() for part in points)
    assert chart.note.startswith("108 of 108 designs judged: 36 pass, 72 fail;")


@pytest.mark.thorough
def test_a_chance_is_that_at_the_worst_condition():
    """A gain of 0.5 passes empty and fails loaded, one of 1 passes both, one of 0 none."""
    content = pairs()
    rows = np.isin(content.variables[1].values, [0.0, 0.5, 1.0])
    gain, rate, load = (each.values[rows] for each in content.variables)
    loads = variable("load", values=(0.0, 1.0), role="condition")
    table = study(
        np.column_stack([gain, rate, load]),
        {"y": content.metrics[0].values[rows]},
        {"y": 0.0},
        variables=[variable("gain"), variable("rate"), loads],
    )
    (found,), _, _ = chances_of(table, planes(table), Naming(table.header.definition))
    assert (found.conditions, found.held) == (2, ())
    passing = found.passing.reshape(found.size, found.size)
    assert passing[:, found.size // 2].max() < 5
    assert passing[:, -1].min() > 95


@pytest.mark.thorough
@pytest.mark.browser
def test_the_cockpit_opens_at_the_worst_condition_and_filters_one(open_report: Open):
    content = pairs()
    page = open_report(content)
    assert counts(page) == [36, 72, 0, 0]
    assert page.inner_text(".headline").startswith(
        "36 of 108 designs on this plane meet every requirement at the worst of 2 conditions"
    )
    assert "216 runs · 108 designs · 2 design variables · 2 conditions" in page.inner_text("header")
    chosen = int(page.inner_text("#selected-run").removeprefix("Run "))
    gain, _, load = (each.values[chosen] for each in content.variables)
    assert (gain > 0.7, load) == (True, 1.0)
    page.select_option("#condition-2", "0")
    settle(page)
    assert counts(page) == [81, 27, 0, 0]
    assert "at load 0" in page.inner_text(".headline")
    assert page.inner_text("#everywhere").strip() == "· 36 of all 108 designs at the worst of 2 conditions"
    assert page.inner_text("#selected-run") == f"Run {chosen - 1}"
    rest(page, 450)
    page.reload()
    page.wait_for_selector("html[data-ready]")
    assert counts(page) == [81, 27, 0, 0]


@pytest.mark.thorough
@pytest.mark.browser
def test_a_run_that_passes_says_that_its_design_does_not(open_report: Open):
    """A gain of 5 / 11 passes empty and fails loaded: run 90 is the first of its pairs, 91 loaded."""
    page = open_report(pairs())
    page.evaluate("location.hash = 'run=90'")
    settle(page)
    assert "pass" in page.inner_text(".run-name .badge")
    assert page.inner_text("#design-verdict") == "Its design at the worst of its conditions: fail, decided by run 91."


@pytest.mark.thorough
@pytest.mark.browser
def test_a_design_that_lacks_a_condition_is_undecided(open_report: Open):
    x, load = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]).T
    condition = ReportVariable("load", "load", "kg", 0, 1, None, 0, load, role="condition")
    variables = (
        ReportVariable("x", "x", "", 0, 1, None, 0, x),
        ReportVariable("z", "z", "", 0, 1, None, 0, x),
        condition,
    )
    page = open_report(_content(variables, x, 2.0, SamplerKind.SCATTERED))
    assert counts(page) == [1, 0, 1, 0]
    assert page.inner_text(".legend li:nth-child(3)").startswith("undecided")
    open_tab(page, "designs")
    assert "\u25cb undecided" in page.inner_text("#leaders")


@pytest.mark.thorough
@pytest.mark.browser
def test_with_a_condition_on_an_axis_the_designs_are_counted_beside(open_report: Open):
    page = open_report(weather())
    assert page.inner_text("#everywhere").strip() == "· 26 of all 82 designs at the worst of 4 conditions"
    assert "1 design variable · 4 conditions" in page.inner_text("header")
    # What is selected first is of a design that passes everywhere, though every point on the axes is at one sky.
    assert "pass" in page.inner_text(".run-name .badge")
    assert page.locator("#design-verdict").count() == 0
    # Of the second configuration if no design of the first passes.
    x = np.linspace(0, 1, 4)
    variables = tuple(ReportVariable(name, name, "", 0, 1, None, 0, x) for name in "xz")
    page = open_report(_content(variables, 1 - x, 0.5, SamplerKind.SCATTERED, ["a", "a", "b", "b"]))
    assert page.inner_text("#selected-run") == "Run 2"


@pytest.mark.thorough
@pytest.mark.browser
def test_scattered_designs_are_counted_once_and_without_objectives_there_is_no_score(open_report: Open):
    page = open_report(scattered())
    assert counts(page) == [25, 75, 0, 0]
    page.select_option("#condition-2", "0.2")
    settle(page)
    assert counts(page) == [45, 55, 0, 0]
    open_tab(page, "designs")
    heads = [text.split("\n")[0].strip() for text in page.locator("#leaders thead th").all_inner_texts()]
    assert "Score" not in heads
    assert page.locator(".criterion").count() == 0
    assert page.inner_text("#feasible-designs") == "25 of 100 designs meet every requirement."
    margins = page.locator("#leaders tbody tr:not(.gap) td:nth-child(6)").all_inner_texts()
    # Least margins of x1 = 0.005, 0.015, …, at worst 0.245 of 0.65 and 0.01 less each.
    assert [float(text.removesuffix("\u202f%")) for text in margins[:3]] == pytest.approx([37.7, 36.2, 34.6], abs=0.06)


@pytest.mark.thorough
@pytest.mark.browser
def test_designs_that_do_not_exercise_a_requirement_do_not_stretch_the_axes(open_report: Open):
    """One design has y = -100 and exercises nothing: the axis shows the others, 0 … 1."""
    x = np.linspace(0, 1, 11)
    y = np.where(x == 1, -100.0, x)
    content = _content(
        (ReportVariable("x", "x", "", 0, 1, None, 0.5, x),), y, 0.5, SamplerKind.SCATTERED, exercised=x < 1
    )
    page = open_report(content)
    open_tab(page, "designs")
    assert "10 designs, 1 that do not exercise every requirement beyond the axes" in page.inner_text("#cloud-note")


@pytest.mark.parametrize("sampler", [SamplerKind.FULL_FACTORIAL, SamplerKind.SCATTERED])
def test_between_values_that_are_apart_nothing_is_interpolated(sampler):
    content = pairs()
    gain, rate, load = content.variables
    wide = dataclasses.replace(rate, apart=(0.0, 0.5, 1.0))
    drawn = dataclasses.replace(content, variables=(gain, wide, load), sampler=sampler)
    data = constraint_plot_data(drawn, "gain", "rate", "c")
    assert data.layers == ()
    assert data.note == "Nothing is known between the values of rate: only the runs are shown, no boundaries."
    assert (data.x_apart, data.y_apart) == ({}, {0.0: "0", 0.5: "0.5", 1.0: "1"})
    assert constraint_plot_data(content, "gain", "rate", "c").layers
    (axes,) = draw_constraint_plot(data).axes
    assert axes.yaxis.get_majorticklocs().tolist() == [0.0, 0.5, 1.0]
    assert axes.get_xscale() == "linear"


def test_a_variable_that_is_sampled_on_a_logarithmic_scale_has_such_an_axis():
    gain = _variable(variable("gain", low=0.1, high=10.0, scale="log"), np.array([0.1, 1.0, 10.0]), ())
    assert (gain.log, gain.apart) == (True, ())
    content = pairs()
    drawn = dataclasses.replace(content, variables=(content.variables[0], gain, content.variables[2]))
    data = dataclasses.replace(constraint_plot_data(content, "gain", "rate", "c"), log=(False, drawn.variables[1].log))
    (axes,) = draw_constraint_plot(data).axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("linear", "log")


@pytest.mark.parametrize(
    ("values", "apart"),
    [
        ((0.3, 0.5, 0.6), True),
        ((0.2, 0.3, 0.4, 0.5), False),
        ((0.05, 0.1, 0.15, 1.0), True),  # a factor of more than 3
        ((0.0, 0.1, 0.2, 0.3), False),
        ((), False),
    ],
)
def test_few_listed_values_and_wide_gaps_are_apart(values, apart):
    listed = variable("x", values=values, low=min(values, default=0.0), high=max(values, default=1.0))
    assert _variable(listed, np.array(values or (0.0, 1.0)), ()).apart == (values if apart else ())
