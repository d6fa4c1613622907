"""The page's cockpit in a real browser: what is switched, pinned, zoomed and brushed, and what an address keeps."""

from __future__ import annotations

import csv
import dataclasses
import io
import itertools
from pathlib import Path

import numpy as np
import pytest
from chromium import rest
from playwright.sync_api import Page
from report_pages import PLANE, Open, counts, ground, open_tab, selected, settle

from dse.report.content.data import ReportContent, ReportVariable, RequirementRow, Runs
from dse.report.verdicts import Mark, overall_marks

pytestmark = pytest.mark.browser

LONG = "\u202eRTL \u2067" + "W" * 10_000


def passing_without(content: ReportContent, requirement: int) -> int:
    """Runs of the first plane that meet every requirement but one."""
    others = tuple(row for index, row in enumerate(content.requirements) if index != requirement)
    return int(np.count_nonzero(overall_marks(dataclasses.replace(content, requirements=others))[PLANE] == Mark.PASS))


def corner(page: Page, across: float, up: float) -> tuple[float, float]:
    """A place of the window, by its shares of the constraint plot between its axes, as it is when all is drawn."""
    settle(page)
    box = page.locator(".plot").bounding_box()
    assert box is not None
    x = box["x"] + 66 + across * (box["width"] - 82)
    return x, box["y"] + box["height"] - 50 - up * (box["height"] - 64)


def drag(page: Page, start: tuple[float, float], end: tuple[float, float], *, key: str = "") -> None:
    """Drags with the mouse, holding a key."""
    if key:
        page.keyboard.down(key)
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*((a + b) / 2 for a, b in zip(start, end, strict=True)))
    page.mouse.move(*end)
    page.mouse.up()
    if key:
        page.keyboard.up(key)
    settle(page)


def fragment(page: Page) -> str:
    """The address's fragment, once it rests."""
    rest(page, 450)
    return str(page.evaluate("location.hash.slice(1)"))


def part(content: ReportContent, rows: list[int]) -> ReportContent:
    """Only some runs, without waveforms."""
    runs = content.runs
    return dataclasses.replace(
        content,
        runs=Runs(
            runs.numbers[rows],
            tuple(runs.configurations[row] for row in rows),
            runs.done[rows],
            tuple(runs.problems[row] for row in rows),
        ),
        variables=tuple(dataclasses.replace(entry, values=entry.values[rows]) for entry in content.variables),
        metrics=tuple(dataclasses.replace(entry, values=entry.values[rows]) for entry in content.metrics),
        requirements=tuple(
            dataclasses.replace(entry, exercised=entry.exercised[rows]) for entry in content.requirements
        ),
        figures=(),
    )


@pytest.mark.thorough
def test_a_requirement_that_is_switched_off_counts_no_more(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    before, drawn = counts(page), ground(page)
    page.uncheck("#switch-0")
    assert counts(page)[0] == passing_without(sliced, 0) > before[0]
    assert "the one requirement that is switched on" in page.inner_text(".headline")
    assert ground(page) != drawn
    page.uncheck("#switch-1")
    settle(page)
    assert "every requirement is switched off" in page.inner_text(".headline")
    page.click("#reset-thresholds")
    assert counts(page) == before
    assert ground(page) == drawn


@pytest.mark.thorough
def test_a_brush_in_the_plot_is_one_everywhere(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    # Between the third and the eighth level of the one, the second and the fifth of the other.
    drag(page, corner(page, 0.15, 0.05), corner(page, 0.75, 0.45), key="Shift")
    x, y = (entry.values for entry in sliced.variables[:2])
    (x0, x1), (y0, y1) = ((v.low, v.high) for v in sliced.variables[:2])
    inside = (x > x0 + 0.15 * (x1 - x0)) & (x < x0 + 0.75 * (x1 - x0)) & (y > y0 + 0.05 * (y1 - y0))
    inside &= y < y0 + 0.45 * (y1 - y0)
    assert sum(counts(page)) == int(inside[PLANE].sum())
    assert page.inner_text("#within b") == str(int(inside.sum()))
    assert page.locator(".chip").count() == 2
    open_tab(page, "runs")
    assert page.inner_text("#filter-all .count") == str(int(inside.sum()))
    lines = page.evaluate("document.querySelector('.parallel').toDataURL()")
    page.locator(".chip button").first.click()
    settle(page)
    assert page.locator(".chip").count() == 1
    assert page.evaluate("document.querySelector('.parallel').toDataURL()") != lines
    page.click("#clear-brushes")
    settle(page)
    assert page.inner_text("#filter-all .count") == "242"


@pytest.mark.thorough
def test_an_address_opens_the_page_as_it_was_left(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    page.uncheck("#switch-1")
    page.fill("#field-atMost-0", "0.3")
    drag(page, corner(page, 0.15, 0.05), corner(page, 0.75, 0.45), key="Shift")
    page.select_option("#fill", "1")
    page.locator(".plot").click(position={"x": 300, "y": 200})
    page.keyboard.press("p")
    page.keyboard.press("+")
    left, run, told = fragment(page), selected(page), counts(page)
    drawn = ground(page)
    page.reload()
    page.wait_for_selector("html[data-ready]")
    assert fragment(page) == left
    assert (selected(page), counts(page)) == (run, told)
    assert not page.is_checked("#switch-1")
    assert page.input_value("#field-atMost-0") == "0.3"
    assert ground(page) == drawn


GARBAGE = (
    "view=nowhere&plane=9,9&fixed=a:b,77:1&zoom=1:2&fill=99&bounds=0:x:y,99:1:1&brushes=metric.99:1:2,variable.0:9:1"
    "&pins=-1,1e9,x&run=1e99&sort=&filter=7&runs.axes=nothing&%E0%A4%A=%&a.b=<script>"
)


@pytest.mark.thorough
def test_an_address_of_garbage_opens_the_page_as_it_is(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    before, run = counts(page), selected(page)
    page.evaluate("text => { location.hash = text }", GARBAGE)
    settle(page)
    assert (counts(page), selected(page)) == (before, run)
    page.reload()
    page.wait_for_selector("html[data-ready]")
    assert (counts(page), selected(page)) == (before, run)


@pytest.mark.thorough
def test_waveforms_follow_the_pointer(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    page.wait_for_selector(".figures .u-wrap")
    before = selected(page)
    # Every second run has waveforms: the fifth of eleven in the third row is run 26.
    page.mouse.move(*corner(page, 0.4, 0.2))
    page.wait_for_selector(".figures[data-run='26']")
    assert "under the pointer" in page.inner_text(".curves")
    assert selected(page) == before
    page.mouse.move(5, 5)
    page.wait_for_selector(f".figures[data-run='{before}']")


@pytest.mark.thorough
def test_up_to_five_runs_are_pinned(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    for across in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0):
        page.keyboard.down("Shift")
        page.mouse.click(*corner(page, across, 0.4))
        page.keyboard.up("Shift")
    settle(page)
    assert page.locator(".curves .pin b").all_inner_texts() == [f"Run {44 + 2 * pin}" for pin in range(5)]
    assert page.is_disabled("#pin")
    # As when the pointer leaves the plot late: what is pressed stays, and the click counts.
    page.mouse.move(*corner(page, 0.3, 0.7))
    page.evaluate("document.querySelector('#unpin-1').dataset.same = 'yes'")
    page.mouse.move(*corner(page, 0.5, 0.2))
    settle(page)
    assert page.get_attribute("#unpin-1", "data-same") == "yes"
    page.click("#unpin-1")
    page.wait_for_function("() => document.querySelectorAll('.curves .pin b').length === 4")
    assert page.locator(".curves .pin b").all_inner_texts() == ["Run 44", "Run 48", "Run 50", "Run 52"]
    page.click("#pin")
    settle(page)
    assert page.inner_text("#pin") == "Unpin selected"


@pytest.mark.thorough
def test_the_plot_zooms_pans_and_goes_back(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    whole = ground(page)
    assert page.is_disabled("#zoom-all")
    page.mouse.move(*corner(page, 0.5, 0.5))
    page.mouse.wheel(0, -500)
    settle(page)
    zoomed = ground(page)
    assert zoomed != whole
    drag(page, corner(page, 0.6, 0.5), corner(page, 0.4, 0.5))
    assert ground(page) not in {whole, zoomed}
    assert "brushes" not in fragment(page)
    page.mouse.dblclick(*corner(page, 0.5, 0.5))
    assert ground(page) == whole
    page.locator(".plot").focus()
    for key in ("+", "Shift+ArrowRight", "-"):
        page.keyboard.press(key)
    assert ground(page) == whole
    page.keyboard.press("+")
    page.keyboard.press("0")
    assert ground(page) == whole


@pytest.mark.thorough
def test_a_zoomed_plot_selects_the_run_that_is_seen(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    page.mouse.move(*corner(page, 0.4, 0.4))
    for _ in range(4):
        page.mouse.wheel(0, -400)
        settle(page)
    page.mouse.click(*corner(page, 0.4, 0.4))
    assert selected(page) == 48


@pytest.mark.thorough
def test_dragging_along_an_axis_brushes_it(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    x, y = corner(page, 0.15, 0)
    drag(page, (x, y + 20), (corner(page, 0.75, 0)[0], y + 20))
    assert page.locator(".chip").count() == 1
    assert sum(counts(page)) == 6 * 11
    open_tab(page, "runs")
    axis = page.locator(".parallel").bounding_box()
    assert axis is not None
    # The second axis stands where its heading does.
    head = page.locator("[id='head-variable.1']").bounding_box()
    assert head is not None
    place = head["x"] + head["width"] / 2
    drag(page, (place, axis["y"] + 10), (place, axis["y"] + axis["height"] / 2))
    assert page.locator(".chip").count() == 2
    upper = float(np.mean([sliced.variables[1].low, sliced.variables[1].high]))
    assert f"{sliced.variables[1].high:g}" in page.locator(".chip b").nth(1).inner_text()
    low = float(page.locator(".chip b").nth(1).inner_text().split(" ")[0])
    assert low == pytest.approx(upper, abs=0.05)


@pytest.mark.thorough
def test_axes_are_chosen_and_ordered(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    open_tab(page, "runs")
    heads = page.locator(".head-axis")
    assert heads.count() == len(sliced.variables) + len(sliced.metrics) + 2
    page.click("#choose-axes")
    page.click("#only-variable")
    settle(page)
    assert heads.count() == 4
    page.uncheck("[id='axis-variable.1']")
    page.check("[id='axis-metric.1']")
    settle(page)
    keys = "Array.from(document.querySelectorAll('.head-axis'), head => head.id)"
    assert page.evaluate(keys) == ["head-variable.0", "head-variable.2", "head-variable.3", "head-metric.1"]
    page.locator("[id='head-metric.1']").focus()
    page.keyboard.press("ArrowLeft")
    settle(page)
    page.keyboard.press("ArrowLeft")
    settle(page)
    moved = ["head-variable.0", "head-metric.1", "head-variable.2", "head-variable.3"]
    assert page.evaluate(keys) == moved
    fragment(page)
    page.reload()
    page.wait_for_selector("html[data-ready]")
    assert page.evaluate(keys) == moved


@pytest.mark.thorough
def test_what_is_brushed_is_the_next_study(sliced: ReportContent, open_report: Open) -> None:
    from ruamel.yaml import YAML

    page = open_report(sliced)
    page.click("#limit-runs")
    page.select_option("#limit-column", "variable.0")
    page.fill("#limit-low", "0.7")
    page.fill("#limit-high", "1.6")
    page.click("#limit button")
    page.click("#limit-runs")
    page.select_option("#limit-column", "metric.0")
    page.fill("#limit-high", "0.5")
    page.fill("#limit-low", "")
    page.click("#limit button")
    settle(page)
    page.click("#next-summary")
    read = YAML(typ="safe").load(page.inner_text("#next-study"))["design_variables"]
    assert [float(end.split()[0]) for end in read["controller.kp_speed"]["range"]] == [0.7, 1.6]
    within = (sliced.variables[0].values >= 0.7) & (sliced.variables[0].values <= 1.6)
    within &= sliced.metrics[0].values <= 0.5
    reach = sliced.variables[1].values[within]
    assert read["controller.kd_speed"]["range"] == pytest.approx([reach.min(), reach.max()])
    assert page.inner_text("#within b") == str(int(within.sum()))


@pytest.mark.thorough
def test_runs_are_saved_with_their_verdicts(sliced: ReportContent, open_report: Open, tmp_path: Path) -> None:
    page = open_report(sliced)
    page.click("#save-constraint-plot")
    assert "--x controller.kp_speed --y controller.kd_speed" in page.inner_text(".card.constraint .menu code")
    with page.expect_download() as saved:
        page.get_by_role("button", name="Runs (CSV)").click()
    saved.value.save_as(tmp_path / "runs.csv")
    rows = list(csv.reader(io.StringIO((tmp_path / "runs.csv").read_text(encoding="utf-8"))))
    assert rows[0][0] == "run"
    assert rows[0][-1] == "verdict"
    names = ("pass", "fail", "not exercised", "failed to run")
    assert [row[-1] for row in rows[1:]] == [names[mark] for mark in overall_marks(sliced)]
    column = rows[0].index("speed P gain [1/s]")
    assert [float(row[column]) for row in rows[1:]] == sliced.variables[0].values.tolist()
    with page.expect_download() as saved:
        page.get_by_role("button", name="Picture (PNG)").click()
    saved.value.save_as(tmp_path / "plot.png")
    assert (tmp_path / "plot.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


@pytest.mark.thorough
def test_a_panel_fills_the_window_until_escape(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    for name in ("constraint", "requirements", "run", "waves"):
        page.click(f".card.{name} .enlarge")
        settle(page)
        box = page.locator(f".card.{name}").bounding_box()
        assert box is not None
        assert (box["x"], box["y"], box["width"], box["height"]) == (0, 0, 1440, 1000)
        assert page.evaluate("document.querySelector('header').inert")
        page.keyboard.press("Escape")
        settle(page)
        assert page.locator(".enlarged").count() == 0
        assert not page.evaluate("document.querySelector('header').inert")
        assert page.evaluate("document.activeElement.classList.contains('enlarge')")


@pytest.mark.thorough
@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1920, 1080), (2560, 1440)])
def test_plot_sliders_and_waveforms_stand_on_one_screen(
    sliced: ReportContent, open_report: Open, width: int, height: int
) -> None:
    page = open_report(sliced)
    page.set_viewport_size({"width": width, "height": height})
    page.wait_for_selector(".figures .u-wrap")
    settle(page)
    for panel in (".plot", ".thresholds", ".figures figure:last-child"):
        box = page.locator(panel).bounding_box()
        assert box is not None
        assert box["y"] >= 0
        assert box["y"] + box["height"] <= height


@pytest.mark.thorough
@pytest.mark.parametrize("rows", [[], [3]])
@pytest.mark.parametrize("kind", ["sliced", "scattered", "bench_only"])
def test_no_run_and_a_single_run_are_shown(
    request: pytest.FixtureRequest, open_report: Open, kind: str, rows: list[int]
) -> None:
    content = part(request.getfixturevalue(kind), rows)
    page = open_report(content)
    assert sum(counts(page)) == len(rows)
    for tab in page.get_by_role("tab").all():
        tab.click()
        settle(page)


@pytest.mark.thorough
def test_a_study_whose_runs_all_failed_says_so(scattered: ReportContent, open_report: Open) -> None:
    runs = len(scattered.runs)
    failed = dataclasses.replace(scattered.runs, done=np.zeros(runs, dtype=bool), problems=("it broke",) * runs)
    nothing = np.full(runs, np.nan)
    content = dataclasses.replace(
        scattered,
        runs=failed,
        metrics=tuple(dataclasses.replace(metric, values=nothing) for metric in scattered.metrics),
        requirements=tuple(
            dataclasses.replace(entry, exercised=np.zeros(runs, dtype=bool)) for entry in scattered.requirements
        ),
        figures=(),
    )
    page = open_report(content)
    assert counts(page) == [0, 0, 0, runs]
    assert page.inner_text(".problem") == "it broke"


@pytest.mark.thorough
def test_thirty_variables_and_five_requirements_leave_room(scattered: ReportContent, open_report: Open) -> None:
    runs = len(scattered.runs)
    draw = np.random.default_rng(1)
    wild = draw.normal(size=runs)
    wild[:40] = np.repeat([np.nan, np.inf, -np.inf, 0.0], 10)
    everywhere = np.ones(runs, dtype=bool)
    content = dataclasses.replace(
        scattered,
        variables=tuple(
            ReportVariable(f"v{i}", f"variable {i} of thirty", "m", 0.0, 1.0, None, 0.5, draw.random(runs))
            for i in range(30)
        ),
        metrics=(dataclasses.replace(scattered.metrics[0], values=wild), *scattered.metrics[1:]),
        requirements=tuple(
            RequirementRow(f"R{i}", f"level {i}", "speed_overshoot", 0.5 - i / 10, None, everywhere) for i in range(5)
        ),
    )
    page = open_report(content)
    page.set_viewport_size({"width": 1440, "height": 900})
    marks = overall_marks(content)
    assert counts(page) == [int(count) for count in np.bincount(marks, minlength=4)]
    box = page.locator(".plot").bounding_box()
    assert box is not None
    assert box["height"] > 250
    open_tab(page, "runs")
    heads = [head.bounding_box() for head in page.locator(".head-axis").all()]
    assert len(heads) == 30 + 3 + 2
    assert all(a and b and a["x"] + a["width"] <= b["x"] for a, b in itertools.pairwise(heads))
    assert page.evaluate("document.documentElement.scrollWidth") <= 1440


@pytest.mark.thorough
@pytest.mark.parametrize("width", [400, 900, 1440, 2560])
def test_names_of_ten_thousand_letters_break_no_panel(sliced: ReportContent, open_report: Open, width: int) -> None:
    content = dataclasses.replace(
        sliced,
        title=LONG,
        variables=tuple(dataclasses.replace(v, title=LONG, unit_symbol=LONG) for v in sliced.variables),
        metrics=tuple(dataclasses.replace(m, title=LONG, unit_symbol=LONG) for m in sliced.metrics),
        requirements=tuple(dataclasses.replace(r, title=LONG) for r in sliced.requirements),
        figures=tuple(dataclasses.replace(f, title=LONG, unit_symbol=LONG) for f in sliced.figures),
        runs=dataclasses.replace(sliced.runs, problems=(LONG,) * len(sliced.runs)),
    )
    page = open_report(content)
    page.set_viewport_size({"width": width, "height": 900})
    for tab in ("plot", "runs"):
        open_tab(page, tab)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert "\u202e" not in page.inner_text("h1")
    sticking_out = """() => [...document.querySelectorAll('.card')].filter(card => card.offsetWidth &&
        card.getBoundingClientRect().right > innerWidth + 1).length"""
    assert page.evaluate(sticking_out) == 0


@pytest.mark.thorough
def test_every_control_has_a_name_and_can_be_reached(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    for tab in ("plot", "runs"):
        open_tab(page, tab)
        nameless = page.evaluate(
            """() => [...document.querySelectorAll('button, input, select, [tabindex="0"]')].filter(each =>
                each.offsetWidth && !each.getAttribute('aria-label') && !each.textContent.trim() &&
                !(each.labels && each.labels.length) && !each.title).map(each => each.outerHTML)"""
        )
        assert nameless == []
        twice = page.evaluate(
            """() => { const ids = [...document.querySelectorAll('[id]')].map(each => each.id);
                return ids.filter((id, index) => ids.indexOf(id) !== index); }"""
        )
        assert twice == []


@pytest.mark.thorough
def test_on_paper_there_is_nothing_to_press(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    page.emulate_media(media="print")
    settle(page)
    for control in ("button", ".menu", ".navigation", ".brushes"):
        assert not any(each.is_visible() for each in page.locator(control).all())
    assert page.locator(".plot").is_visible()
    assert page.locator(".thresholds").is_visible()


@pytest.mark.thorough
def test_for_paper_all_views_stand_one_after_the_other_and_go_back_into_tabs(
    sliced: ReportContent, open_report: Open
) -> None:
    page = open_report(sliced)
    tabs = page.locator("[role=tab]").all_inner_texts()
    page.evaluate(
        """() => { window.print = () => {
            window.most = [...document.querySelectorAll('.printed > h2')].map(heading => heading.innerText);
            window.dispatchEvent(new Event('afterprint'));
        } }"""
    )
    page.click("#print")
    page.wait_for_function("() => window.most && !document.querySelector('.printed')")
    assert page.evaluate("window.most") == tabs
    assert len(tabs) > 2
    assert page.locator("#view > *").count() == 1
    page.click("#tab-runs")
    page.wait_for_selector(".table", state="visible")


@pytest.mark.thorough
@pytest.mark.parametrize(("view", "table"), [("runs", ".table"), ("designs", "#leaders")])
def test_a_range_in_a_heading_filters_every_view(
    sliced: ReportContent, open_report: Open, view: str, table: str
) -> None:
    page = open_report(sliced)
    open_tab(page, view)
    gains = sliced.variables[0]
    column = page.locator(f"{table} th", has_text=gains.title).locator(".heading-range")
    column.scroll_into_view_if_needed()

    def place(share: float) -> tuple[float, float]:
        box = column.bounding_box()
        assert box is not None
        return box["x"] + share * box["width"], box["y"] + box["height"] / 2

    drag(page, place(0.24), place(0.66))
    settle(page)

    def within() -> int:
        return int(page.inner_text("#within b"))

    ends = [gains.low + share * (gains.high - gains.low) for share in (0.24, 0.66)]
    assert within() == int(((gains.values >= ends[0]) & (gains.values <= ends[1])).sum()) > 0
    assert page.locator(".chip", has_text=gains.title).count() == 1
    # A handle by the keyboard: to its end, and back until nothing is brushed.
    first, last = column.locator("[role=slider]").all()
    last.focus()
    page.keyboard.press("End")
    settle(page)
    assert within() == int((gains.values >= ends[0]).sum())
    first.focus()
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    settle(page)
    assert within() == int((gains.values >= ends[0] + 0.1 * (gains.high - gains.low)).sum())
    assert first.evaluate("handle => document.activeElement === handle")
    page.keyboard.press("Escape")
    settle(page)
    assert page.locator(".chip").count() == 0
    # A handle that is dragged leaves the other one where it is.
    drag(page, place(1), place(0.55))
    settle(page)
    assert within() == int((gains.values <= gains.low + 0.55 * (gains.high - gains.low)).sum())
    page.mouse.click(*place(0.25))
    settle(page)
    assert page.locator(".chip").count() == 0
