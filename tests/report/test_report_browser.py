"""The page in a real browser: what a reader does, and what must never happen."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
from playwright.sync_api import Locator, Page, Position
from report_pages import PLANE, Open, counts, expected, ground, open_tab, selected, settle

from dse.errors import Problem
from dse.report.charts.chart import Axis, Band, Bars, Chart, Line, Rule, Steps, limits
from dse.report.content.data import ReportContent, RequirementRow
from dse.report.figure import ShownFigure, charted
from dse.report.page import html as page_module
from dse.report.verdicts import Mark, overall_marks

pytestmark = pytest.mark.browser

HOSTILE = '</script><img src=x onerror="window.pwned=1"><b>'
Figures = Callable[[ReportContent, tuple[Chart, ...] | None], ReportContent]


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> Figures:
    """Has the page show one made-up figure of these charts, or one that failed, in place of all others."""

    def shown(content: ReportContent, charts: tuple[Chart, ...] | None) -> ReportContent:
        why = None if charts else Problem(f"the figure 'made up' cannot be drawn: ValueError: {HOSTILE}")
        figure = ShownFigure("made up", "made up", charts or (), why)
        monkeypatch.setattr(page_module, "shown_figures", lambda _: (figure,))
        return content

    return shown


@pytest.mark.thorough
def test_the_counts_are_those_that_python_finds(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    assert counts(page) == expected(sliced, 0.5, 1.0, runs=PLANE)
    assert page.inner_text("#passing") == str(expected(sliced, 0.5, 1.0, runs=PLANE)[0])
    assert page.inner_text(".headline").endswith(f" · {expected(sliced, 0.5, 1.0)[0]} of all 242")


@pytest.mark.thorough
def test_moving_a_threshold_moves_the_counts_and_the_plot(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    before = ground(page)
    page.fill("#field-atMost-0", "0.1")
    assert counts(page) == expected(sliced, 0.1, 1.0, runs=PLANE) != expected(sliced, 0.5, 1.0, runs=PLANE)
    assert ground(page) != before
    page.eval_on_selector("#slider-atMost-0", "s => { s.value = s.max; s.dispatchEvent(new Event('input')) }")
    assert counts(page) == expected(sliced, float(page.input_value("#slider-atMost-0")), 1.0, runs=PLANE)
    page.click("#reset-thresholds")
    assert counts(page) == expected(sliced, 0.5, 1.0, runs=PLANE)
    assert ground(page) == before
    assert page.is_disabled("#reset-thresholds")


@pytest.mark.thorough
def test_a_requirement_with_two_bounds_has_two_sliders(sliced: ReportContent, open_report: Open) -> None:
    both = RequirementRow("R3", "braking", "peak_deceleration", 0.7, 0.4, np.ones(len(sliced.runs), dtype=bool))
    content = dataclasses.replace(sliced, requirements=(both,))
    page = open_report(content)
    assert counts(page) == expected(content, 0.7, runs=PLANE)
    page.fill("#field-atLeast-0", "0.6")
    stricter = dataclasses.replace(content, requirements=(dataclasses.replace(both, at_least=0.6),))
    assert counts(page) == expected(stricter, 0.7, runs=PLANE) != expected(content, 0.7, runs=PLANE)


@pytest.mark.thorough
def test_a_click_selects_the_run_under_it(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    assert page.get_attribute(".figures", "data-run") == str(selected(page))
    box = page.locator(".plot").bounding_box()
    assert box is not None
    # The plot leaves 66, 16, 14 and 50 pixels for its axes; run 24 is the third of eleven in the third row.
    x, y = 66 + 0.2 * (box["width"] - 82), 14 + 0.8 * (box["height"] - 64)
    page.locator(".plot").click(position={"x": x + 2, "y": y - 2})
    assert selected(page) == 24
    page.wait_for_selector(".figures[data-run='24'] .u-wrap")
    value = sliced.metrics[0].values[24]
    page.click(".numbers summary")
    shown = page.inner_text("#metrics tbody tr:first-child td:nth-child(2)").replace("\u2212", "-").split("\u202f")
    assert float(shown[0]) == pytest.approx(value, abs=0.006)
    assert shown[1] == "%"
    assert page.inner_text(".tip .head").startswith("Run 24")
    page.click(".yaml summary")
    kept = page.inner_text("#yaml").splitlines()
    assert kept[1] == "configuration: c4f1a2"
    assert f"  controller.kd_speed: {sliced.variables[1].values[24]}" in kept


@pytest.mark.thorough
def test_arrow_keys_walk_along_the_grid(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    page.locator(".plot").click(position={"x": 300, "y": 200})
    page.locator(".plot").focus()
    start = selected(page)
    for key, step in (("ArrowRight", 1), ("ArrowUp", 11), ("ArrowLeft", -1), ("ArrowDown", -11)):
        page.keyboard.press(key)
        start += step
        assert selected(page) == start
    page.wait_for_function(
        "run => document.getElementById('announcement').textContent.startsWith(`Run ${run},`)", arg=start
    )


@pytest.mark.thorough
def test_a_waveform_that_was_not_kept_names_the_command(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    run = next(number for number in range(20, 242) if number not in sliced.figures[0].kept and number != 37)
    open_tab(page, "runs")
    page.eval_on_selector(".table .view", f"view => view.scrollTop = {run} * 28")
    settle(page)
    page.click(f".table tbody tr:has(td:first-child:text-is('{run}'))")
    open_tab(page, "plot")
    page.wait_for_selector(f"code:text-is('dse replay DIR {run}')")


@pytest.mark.thorough
def test_the_other_slice_shows_its_own_runs(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    before = ground(page)
    page.click("#slice-1")
    assert ground(page) != before
    assert page.get_attribute("#slice-1", "aria-pressed") == "true"
    page.locator(".plot").click(position={"x": 300, "y": 200})
    assert selected(page) >= 121


@pytest.mark.thorough
def test_the_run_table_sorts_and_filters(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    open_tab(page, "runs")
    page.click("[data-sort='metric.1']")
    page.click("[data-sort='metric.1']")
    page.eval_on_selector(".table .view", "view => view.scrollTop = 0")
    settle(page)
    first = int(page.inner_text(".table tbody tr:not(.gap) td:first-child"))
    assert first == int(np.nanargmax(sliced.metrics[1].values))
    page.click("#filter-3")
    settle(page)
    rows = page.locator(".table tbody tr:not(.gap)")
    assert rows.count() == np.count_nonzero(overall_marks(sliced) == Mark.FAILED_TO_RUN) == 2
    rows.first.click()
    open_tab(page, "plot")
    assert "fmi2DoStep" in page.inner_text(".problem")


@pytest.mark.thorough
def test_dark_mode_redraws_everything(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    light, colour = ground(page), page.evaluate("getComputedStyle(document.body).backgroundColor")
    open_tab(page, "figures")
    chart = page.evaluate("document.querySelector('.sheet canvas').toDataURL()")
    page.click("#theme")
    settle(page)
    assert page.evaluate("document.querySelector('.sheet canvas').toDataURL()") != chart
    open_tab(page, "plot")
    assert ground(page) != light
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") != colour
    assert page.inner_text("#theme") == "Light mode"


@pytest.mark.thorough
def test_a_metric_can_be_shown_as_colour(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    before = ground(page)
    page.select_option("#fill", "1")
    assert ground(page) != before


@pytest.mark.thorough
def test_configurations_without_variables_are_a_table(bench_only: ReportContent, open_report: Open) -> None:
    page = open_report(bench_only)
    assert page.locator(".plot").count() == 0
    assert counts(page) == expected(bench_only, 0.5, 1.0)
    page.click("#configurations tbody tr:nth-child(2)")
    assert selected(page) == 1
    page.wait_for_selector(".figures[data-run='1'] .u-wrap")
    page.click("#configurations tbody tr:nth-child(5)")
    page.wait_for_selector("code:text-is('dse replay DIR 4')")


@pytest.mark.thorough
def test_scattered_runs_have_regions_that_follow_the_sliders(scattered: ReportContent, open_report: Open) -> None:
    page = open_report(scattered)
    assert "radial functions through 200 runs" in page.inner_text("#plane-note")
    before = ground(page)
    page.eval_on_selector("#fixed-3", "s => { s.value = s.min; s.dispatchEvent(new Event('input')) }")
    assert ground(page) != before
    page.click("#through-selected")
    settle(page)
    reading = page.inner_text("#reading-3")
    shown = page.inner_text(".parameters div:nth-child(4) dd")
    assert reading == shown


@pytest.mark.thorough
def test_names_that_are_markup_stay_text(sliced: ReportContent, open_report: Open) -> None:
    content = dataclasses.replace(
        sliced,
        title=HOSTILE,
        facts=((HOSTILE, HOSTILE),),
        variables=tuple(dataclasses.replace(v, title=HOSTILE, unit_symbol=HOSTILE) for v in sliced.variables),
        metrics=tuple(dataclasses.replace(m, title=HOSTILE, unit_symbol=HOSTILE) for m in sliced.metrics),
        requirements=tuple(dataclasses.replace(r, title=HOSTILE) for r in sliced.requirements),
        figures=tuple(dataclasses.replace(f, title=HOSTILE, current_label=HOSTILE) for f in sliced.figures),
        runs=dataclasses.replace(sliced.runs, problems=(HOSTILE,) * len(sliced.runs)),
    )
    page = open_report(content)
    page.hover(".plot", position={"x": 300, "y": 200})
    page.locator(".plot").click(position={"x": 300, "y": 200})
    page.wait_for_selector(".figures:not([hidden]) .u-wrap, .missing code")
    open_tab(page, "figures")
    page.locator(".sheet").first.hover(position={"x": 300, "y": 120})
    assert HOSTILE in page.locator(".sheets figcaption b").first.inner_text()
    assert page.inner_text("h1") == HOSTILE
    assert page.title() == HOSTILE
    assert page.evaluate("window.pwned") is None
    assert page.locator("img").count() == 0


@pytest.mark.thorough
@pytest.mark.parametrize("width", [420, 900, 1280, 1920])
def test_nothing_sticks_out_sideways(sliced: ReportContent, open_report: Open, width: int) -> None:
    page = open_report(sliced)
    page.set_viewport_size({"width": width, "height": 900})
    settle(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.thorough
def test_what_finer_numerics_may_change_is_doubtful_and_follows_the_threshold(
    sliced: ReportContent, open_report: Open
) -> None:
    runs = len(sliced.runs)
    first, *others = sliced.metrics
    assert (sliced.requirements[0].metric, sliced.requirements[0].at_most) == (first.name, 0.5)
    # Passing runs pass by 0.1 and all bars but the last run's, which was not checked, are 0.12.
    values = np.where(first.values <= 0.5, 0.4, 0.9)
    checked = np.arange(runs) < runs - 1
    column = dataclasses.replace(first, values=values, error=np.full(runs, 0.12))
    content = dataclasses.replace(
        sliced, metrics=(column, *others), runs=dataclasses.replace(sliced.runs, checked=checked)
    )
    passing = (overall_marks(content) == Mark.PASS) & checked
    page = open_report(content)
    settle(page)
    assert page.inner_text("#doubtful").split()[1] == str(int(passing[PLANE].sum()))
    page.fill("#field-atMost-0", "0.6")
    settle(page)
    assert page.inner_text("#doubtful") == ""


@pytest.mark.thorough
def test_a_small_page_shows_every_verdict(sliced: ReportContent, open_report: Open) -> None:
    runs = len(sliced.runs)
    checked = tuple(dataclasses.replace(m, error=np.full(runs, 0.00022)) for m in sliced.metrics)
    page = open_report(dataclasses.replace(sliced, metrics=checked))
    page.set_viewport_size({"width": 420, "height": 900})
    page.click(".numbers summary")
    settle(page)
    assert page.locator("#metrics tbody td").first.inner_text().endswith(" \u00b1\u202f0.00022\u202f%")
    box = page.locator("#metrics tbody td.verdict").first.bounding_box()
    assert box is not None
    assert box["x"] + box["width"] <= 420
    assert page.evaluate("document.querySelector('#metrics').scrollWidth") <= 420


def progress_of(page: Page, requirement: int) -> Locator:
    """The chart of a requirement's metric over the runs."""
    open_tab(page, "figures")
    return page.locator(".charted > .sheets").nth(1).locator("figure").nth(requirement)


def place_in(chart: Locator, drawn: Chart, x: float, y: float) -> Position:
    """Where a value lies; a chart leaves 66, 16, 10 and 50 pixels for its axes."""
    box = chart.locator(".sheet").bounding_box()
    assert box is not None
    (left, right), (low, high) = limits(drawn)
    across, up = (x - left) / (right - left), (y - low) / (high - low)
    return {"x": 66 + across * (box["width"] - 82), "y": box["height"] - 50 - up * (box["height"] - 60)}


@pytest.mark.thorough
def test_every_figure_has_a_heading_and_its_charts_are_described(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    open_tab(page, "figures")
    assert page.locator(".charted h3").all_inner_texts() == ["Margins of the requirements", "Progress of the study"]
    assert page.locator(".sheets figcaption").count() == 4
    described = str(progress_of(page, 1).locator(".sheet").get_attribute("aria-label"))
    assert described.startswith(
        "no distance undershoot: distance undershoot [%] over run number [\u2013], 240 points. "
    )
    assert "at most 1 %" in described
    note = progress_of(page, 1).locator(".hint").inner_text()
    assert "2 failed to run" in note


@pytest.mark.thorough
def test_a_click_on_a_point_of_a_chart_selects_its_run_everywhere(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    chart = progress_of(page, 0)
    place = place_in(chart, charted("progress", sliced).charts[0], 24, sliced.metrics[0].values[24])
    chart.locator(".sheet").hover(position=place)
    assert chart.locator(".reading").inner_text().startswith("Run 24 \u00b7 ")
    chart.locator(".sheet").click(position=place)
    page.mouse.move(0, 0)
    readings = page.locator(".sheets .reading").all_inner_texts()
    assert all(reading.startswith("Run 24 \u00b7 ") for reading in readings if reading.strip())
    assert selected(page) == 24
    page.wait_for_selector(".figures[data-run='24'] .u-wrap")
    shown = readings[2].rsplit(" ", 1)[1].split("\u202f")[0].replace("\u2212", "-")
    assert float(shown) == pytest.approx(sliced.metrics[0].values[24], rel=1e-3)


@pytest.mark.thorough
def test_arrow_keys_walk_along_a_chart(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    progress_of(page, 0).locator(".sheet").focus()
    walk = (("Home", 0), ("ArrowRight", 1), ("ArrowRight", 2), ("ArrowLeft", 1), ("End", 241), ("ArrowRight", 241))
    for key, run in walk:
        page.keyboard.press(key)
        page.wait_for_function("run => new RegExp(`run=${run}(&|$)`).test(location.hash)", arg=run)


@pytest.mark.thorough
def test_a_chart_can_be_left_with_the_tabulator(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    progress_of(page, 0).locator(".sheet").focus()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.getAttribute('aria-label')").startswith("no distance undershoot")


@pytest.mark.thorough
def test_a_chart_without_runs_is_read_out(sliced: ReportContent, open_report: Open, figures: Figures) -> None:
    page = open_report(figures(sliced, EVERYTHING))
    before = selected(page)
    open_tab(page, "figures")
    charts = page.locator(".sheets figure")
    for index in range(charts.count()):
        charts.nth(index).locator(".sheet").focus()
        page.keyboard.press("Home")
        page.keyboard.press("ArrowRight")
        text = charts.nth(index).locator(".reading").inner_text()
        assert text == ("all \u00b7 disc \u00b7 runs 2" if index else "fit \u00b7 time 1\u202fs \u00b7 gap 1\u202fm")
    assert charts.first.locator(".legend li").all_inner_texts() == ["spread", "fit", "held"]
    assert selected(page) == before


@pytest.mark.thorough
def test_a_figure_that_failed_is_named_in_its_place(sliced: ReportContent, open_report: Open, figures: Figures) -> None:
    page = open_report(figures(sliced, None))
    open_tab(page, "figures")
    assert page.inner_text(".charted .problem") == f"the figure 'made up' cannot be drawn: ValueError: {HOSTILE}"
    assert page.locator("img").count() == 0


AXES = (Axis("time", "s", log=True), Axis("gap", "m"))
TIMES = np.array([1.0, 10.0, 100.0])
EVERYTHING = (
    Chart(
        "curves",
        "Curves",
        *AXES,
        (
            Band(TIMES, TIMES / 50, TIMES / 20 + 1, "spread"),
            Line(TIMES, np.array([1.0, 3.0, np.nan]), "fit"),
            Steps(TIMES, np.array([5.0, 4.0, 3.0]), "held"),
            Rule("x", 20.0),
        ),
    ),
    Chart(
        "bars",
        "Bars",
        Axis("brake", names=("drum", "disc", "wire")),
        Axis("runs"),
        (Bars(np.arange(4) - 0.5, np.array([1.0, 2.0, 3.0]), "all"),),
    ),
)
